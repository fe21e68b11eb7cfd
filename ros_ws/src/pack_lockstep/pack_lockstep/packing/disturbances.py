"""What is done to the markers of the packing cell in each stage: hidden, confused, or not there at all."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from pack_core.packing.cell import packing_cell
from pack_core.packing.goals import PackingMethod
from pack_core.packing.markers import MarkerFrame
from pack_core.rotations import angle_between
from pack_lockstep.disturbances import Disturbance, DisturbanceReport, DisturbanceTable
from pack_lockstep.packing.lockstep import HELD, Lockstep, Step
from pack_lockstep.packing.lockstep_config import lockstep_config
from pack_sim.packing.scene_generator import generate_scene

LASTS = 5.0
"""How long the cameras are deceived [s]."""
FALSE = np.array([0.05, 0.0, 0.02])
"""From a marker to one that is not there [m]."""

Rows = npt.NDArray[np.int_]
MarkerChange = Callable[[MarkerFrame, str], MarkerFrame]


def hide_all(frame: MarkerFrame, _: str) -> MarkerFrame:
    """A frame in which nothing is seen."""
    return _kept(frame, np.zeros(0, dtype=int))


def hide_one(frame: MarkerFrame, name: str) -> MarkerFrame:
    """A frame in which no marker of an object is seen."""
    return _kept(frame, np.flatnonzero(frame.object_index != frame.objects.index(name)))


def swap_within(frame: MarkerFrame, name: str) -> MarkerFrame:
    """A frame in which two markers of an object are taken for each other."""
    return _swapped(frame, _of(frame, name)[:2])


def swap_between(frame: MarkerFrame, name: str) -> MarkerFrame:
    """A frame in which a marker of an object and one of another object are taken for each other."""
    others = np.flatnonzero(frame.object_index != frame.objects.index(name))
    return _swapped(frame, np.array([*_of(frame, name)[:1], *others[:1]]))


def add_false(frame: MarkerFrame, name: str) -> MarkerFrame:
    """A frame in which a reflection is taken for the first marker of an object."""
    rows = _of(frame, name)[:1]
    p_WM = frame.p_WM.copy()
    p_WM[rows] += FALSE
    return replace(frame, p_WM=p_WM)


def _of(frame: MarkerFrame, name: str) -> Rows:
    return np.flatnonzero(frame.object_index == frame.objects.index(name))


def _kept(frame: MarkerFrame, rows: Rows) -> MarkerFrame:
    return replace(
        frame, object_index=frame.object_index[rows], marker_index=frame.marker_index[rows],
        p_WM=frame.p_WM[rows], cameras=frame.cameras[rows],
    )  # fmt: skip


def _swapped(frame: MarkerFrame, pair: Rows) -> MarkerFrame:
    if len(pair) < 2:
        return frame
    p_WM = frame.p_WM.copy()
    p_WM[pair] = p_WM[pair[::-1]]
    return replace(frame, p_WM=p_WM)


CHANGES: dict[str, MarkerChange] = {
    "nothing": lambda frame, _: frame,
    "all markers hidden": hide_all,
    "held object's markers hidden": hide_one,
    "two of its markers swapped": swap_within,
    "one swapped with another object's": swap_between,
    "a false marker": add_false,
}
STAGES = ("PRE_PACK", "INSERT", "FINE_TUNE")


class MarkerDisturber:
    """Deceives the cameras from a stage on for `LASTS`, and notes what the estimate is worth meanwhile.

    Args:
        case: what is done, and when.
        lockstep: the run.
    """

    def __init__(self, case: Disturbance, lockstep: Lockstep) -> None:
        self._case, self._lockstep = case, lockstep
        self._change, self._held = CHANGES[case.what], lockstep.session.scene.new_object.name
        self.since: float | None = None
        self.held_at: float | None = None
        self.error, self.angle, self.age, self.held_for = 0.0, 0.0, 0.0, 0.0
        self._last = 0.0
        lockstep.deceive(self._deceive)

    def _deceive(self, frame: MarkerFrame) -> MarkerFrame:
        return self._change(frame, self._held) if self._is_on(frame.time) else frame

    def _is_on(self, time: float) -> bool:
        return self.since is not None and self.since <= time < self.since + LASTS

    def __call__(self, step: Step) -> None:
        """Look at a cycle."""
        if self.since is None and step.stage == self._case.when:
            self.since = step.time
        if step.stage == HELD:
            self.held_at = step.time if self.held_at is None else self.held_at
            self.held_for += step.time - self._last
        self._last = step.time
        if not self._is_on(step.time):
            return
        for name, state in step.seen.scene.objects.items():
            true = step.truth.objects[name].X_WO
            self.error = max(self.error, float(np.linalg.norm(state.X_WO.p - true.p)))
            self.angle = max(self.angle, float(angle_between(state.X_WO.q, true.q)))
            self.age = max(self.age, state.age)


def run_case(case: Disturbance, seed: int) -> DisturbanceReport:
    """Run the scene of a seed, and deceive the cameras as the case says."""
    cell = packing_cell()
    scene = generate_scene(seed, cell)
    lockstep = Lockstep(cell, scene, lockstep_config(), PackingMethod.PACK_IT_IN, seed)
    disturber = MarkerDisturber(case, lockstep)
    outcome = lockstep.run(disturber)
    if disturber.since is None:
        return DisturbanceReport(case.name, case.what, case.when, problem="the stage was not reached")
    noticed = [f"oldest pose {disturber.age:.1f} s"] if disturber.age > 0.1 else []
    if disturber.held_at is not None:
        noticed.append(f"the arm held for {disturber.held_for:.1f} s")
    after = float("nan") if disturber.held_at is None else disturber.held_at - disturber.since
    return DisturbanceReport(
        case.name, case.what, case.when, tuple(noticed), after,
        f"{outcome.exit_reason.value} after {outcome.execution_time:.1f} s, {outcome.placements} placements",
        f"{int(outcome.success)} of 1", 1e3 * disturber.error, float(np.rad2deg(disturber.angle)),
    )  # fmt: skip


DISTURBANCES = DisturbanceTable(
    tuple(Disturbance(what, when) for when in STAGES for what in CHANGES), run_case,
    "each lasts 5 s; worst: of an estimated pose meanwhile, against the true one",
)  # fmt: skip
