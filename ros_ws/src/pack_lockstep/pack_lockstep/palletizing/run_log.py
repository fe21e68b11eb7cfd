"""Collects a lockstep run as the arrays that its evaluation takes."""

from __future__ import annotations

import numpy as np

from pack_core.motion.moves import Mode
from pack_core.motion.target import MotionStatus
from pack_core.palletizing.cell import PalletizingCell
from pack_core.palletizing.grip import GripLoad
from pack_core.palletizing.topics import TRUTH_RATE
from pack_core.rotations import Array, Pose
from pack_core.states import SceneState
from pack_core.topics import steps_between
from pack_evaluation.palletizing.run import (
    BoxRecord,
    PalletRun,
    SentTarget,
    SeparationTrack,
    StandingCell,
    StateVisit,
    ToolTrack,
    UnwantedTouch,
    VisitorTrack,
    WayPoint,
    intervals,
    tool_track,
)
from pack_evaluation.track import to_tracks
from pack_motion.controller import MotionController
from pack_sim.palletizing.simulator import PalletSimulator
from pallet_fsm.report import BoxReport, OrderReport
from pallet_fsm.states import State


class PalletRunLog:
    """Records the arm in every step, and the boxes at the rate of /sim/truth.

    Args:
        simulator: the simulator that is recorded.
        period: time between two steps [s].
        known: the cell as the machine knows it. Planned poses are relative to the pallet that it knows; they
            are recorded relative to the true one.
    """

    def __init__(self, simulator: PalletSimulator, period: float, known: PalletizingCell) -> None:
        self._simulator, self._box_steps = simulator, steps_between(TRUTH_RATE, period)
        self._known = known
        self._times: list[float] = []
        self._is_slow: list[bool] = []
        self._joints: list[tuple[Array, Array, Array]] = []
        self._truth: list[SceneState] = []
        self._peaks: dict[str, GripLoad] = {}
        self._way_points: list[WayPoint] = []
        self._targets: list[SentTarget] = []
        self._visitors: dict[str, list[tuple[float, float]]] = {}
        self._separation: list[tuple[float, bool]] = []

    def note(self, q_ref: Array, motion: MotionController) -> None:
        """Record the present state.

        Args:
            q_ref: joint positions of the present setpoint `(n,)` [rad].
            motion: what made it.
        """
        simulator = self._simulator
        self._times.append(simulator.time)
        self._is_slow.append(motion.mode is Mode.SLOW)
        self._joints.append((q_ref, simulator.joints().q, simulator.link_angles()))
        self._separation.append((motion.margin.value, motion.is_under_way))
        if held := simulator.gripper.state.held:
            self._peaks[held] = simulator.gripper.state.peak.worst(self._peaks.get(held, GripLoad()))
        if len(self._times) % self._box_steps == 0:
            truth = simulator.truth()
            self._truth.append(truth)
            for name, distance in simulator.visitor_distances().items():
                self._visitors.setdefault(name, []).append((truth.time, distance))

    def note_target(self, X_WT: Pose) -> None:
        """Record that the motion pursues a target with this pose of the tool at its end."""
        self._targets.append(SentTarget(self._simulator.time, X_WT))

    def note_way_point(self, state: State, status: MotionStatus) -> None:
        """Record that a state's target was confirmed, with the status on which that was done."""
        errors = 1e3 * status.position_error, float(np.rad2deg(status.orientation_error))
        self._way_points.append(WayPoint(state.label, *errors))

    def run(self, seed: int, report: OrderReport) -> PalletRun:
        """The record of a run that has ended."""
        return PalletRun(
            report.order, seed, report.reason,
            tuple(_record(box, self._planned(box.X_WB)) for box in report.boxes),
            tuple(StateVisit(v.state.label, v.time, v.box, v.reason) for v in report.visits),
            self._tool(),
            to_tracks(self._truth),
            tuple(UnwantedTouch(e.time, e.bodies, e.force) for e in self._simulator.contacts.events),
            report.cycle_times(),
            {name: (load.coaxial, load.shear, load.moment) for name, load in self._peaks.items()},
            visitors={name: VisitorTrack(*np.array(rows).T) for name, rows in self._visitors.items()},
            separation=self._kept(),
            way_points=tuple(self._way_points),
            stands=StandingCell(self._simulator.cell, self._simulator.X_WB),
            slow=intervals(self._times, self._is_slow),
            targets=tuple(self._targets),
        )  # fmt: skip

    def _kept(self) -> SeparationTrack | None:
        if not self._visitors:
            return None
        margin, is_under_way = zip(*self._separation, strict=True)
        return SeparationTrack(np.array(self._times), np.array(margin), np.array(is_under_way))

    def _tool(self) -> ToolTrack:
        wanted, measured, true = (np.array([row[i] for row in self._joints]) for i in (0, 1, 2))
        return tool_track(np.array(self._times), wanted, measured, true)

    def _planned(self, X_WB: Pose) -> Pose:
        true = self._simulator.cell.pallet
        if true.displacement == self._known.pallet.displacement:
            return X_WB
        return true.X_WP @ self._known.pallet.X_WP.inverse() @ X_WB


def _record(box: BoxReport, X_WB: Pose) -> BoxRecord:
    return BoxRecord(
        box.name, box.dims, box.mass, box.handling, box.outcome, box.reason, box.direction, X_WB, box.weighed
    )
