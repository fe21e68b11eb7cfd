"""A fill job in one process, without ROS, on simulated time: the cores of the nodes, as in `Lockstep`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from pack_core.joints import hold
from pack_core.packing.cell import PackingCell
from pack_core.packing.goals import Arrangement, FillMethod, PackingMethod
from pack_core.packing.packing_list import PackingList
from pack_evaluation.packing.fill.true_end import TrueEnd, true_end
from pack_lockstep.packing.lockstep import LockstepCell, LockstepPlacements, Sense, cycles
from pack_lockstep.packing.lockstep_config import LockstepConfig
from pack_mpc.filling.fill_job import FillJob, FillReport
from pack_mpc.filling.requests import (
    Arrange,
    FillObservation,
    FillRequest,
    Judge,
    Pack,
    Packed,
    Present,
    Presented,
    UsePump,
)
from pack_mpc.observation import PackingObservation, unseen_of
from pack_mpc.session import PackingSession
from pack_mpc.task.force_record import ForceRecord
from pack_planner.filling.fill_planner import FillPlanner
from pack_planner.placement.placement_planner import PlacementPlanners


@dataclass(frozen=True)
class FillResult:
    """A job's report, beside what is true at its end.

    Attributes:
        report: what the job itself saw.
        given: number of objects of the list.
        truth: how the job truly ended.
        force_peak: largest external force of the whole job, behind a low-pass of 5 ms [N].
    """

    report: FillReport
    given: int
    truth: TrueEnd
    force_peak: float

    @property
    def faults(self) -> list[str]:
        """What went wrong, in words."""
        found = {row.name: row.reason for row in self.report.objects if row.has_fault}
        found = dict.fromkeys(self.truth.outside, "it ends outside") | found
        return [f"{name}: {reason}" for name, reason in sorted(found.items())]

    def measures(self) -> dict[str, Any]:
        """Plain values for the file of results; times in [s], the force in [N], shares from 0 to 1."""
        rows, truth = self.report.objects, self.truth
        return {
            "without_fault": not self.faults, "faults": self.faults, "objects": len(truth.inside),
            "given": self.given, "base_area": truth.fill.base_area, "volume": truth.fill.volume,
            "durations": [row.duration for row in rows if row.name in truth.inside],
            "force": self.force_peak,
            "fills": [[time, fill.base_area, fill.volume] for time, fill in self.report.fills],
        }  # fmt: skip


PERIOD = 0.02
"""Time between two steps of the job while no goal is in progress [s]."""


class FillLockstep:
    """Runs one list from its first object to the end.

    Args:
        cell: the cell's physical facts.
        given: the list.
        config: parameters.
        method: how places are chosen.
        seed: seed of the sensors' noise, the hand-overs and the placements.
        sense: called after every step of the physics.
    """

    def __init__(
        self, cell: PackingCell, given: PackingList, config: LockstepConfig, method: FillMethod, seed: int,
        sense: Sense | None = None,
    ) -> None:  # fmt: skip
        self._physical, self._config, self._method, self._seed = cell, config, method, seed
        self._given = len(given.objects)
        self.cell = LockstepCell(cell, given.start(cell), config, seed, sense or (lambda *_: None))
        self.simulator = self.cell.simulator
        self._planner = FillPlanner(config.planner.arrangement, method, given.order)
        self._forces, self._force_peak = ForceRecord(), 0.0
        self._rng = np.random.default_rng([seed, 1])
        self.job = FillJob(given, cell, config.session.fill, self.simulator.description)
        self.cell.settle()

    def run(self, on_step: Callable[[FillLockstep], None] | None = None) -> FillReport:
        """Run to the end; `on_step` is called after every step of the job and of its goals."""
        answer: object | None = None
        while not self.job.is_done:
            command = self.job.step(self._observe(answer))
            answer = None if command.request is None else self._serve(command.request, on_step)
            if command.setpoints is not None:
                self.cell.send(command.setpoints)
            if answer is None:
                self.cell.advance(PERIOD)
            if on_step is not None:
                on_step(self)
        return self.job.report

    def result(self) -> FillResult:
        """The job's report, and what is true."""
        scene, truth = self.simulator.scene, self.simulator.truth()
        place = self._physical.hand_over
        ends = {
            name: (place.pose_of(scene.model_of(name)), truth.objects[name].X_WO)
            for name in (*scene.names, scene.new_object.name)
        }
        return FillResult(self.job.report, self._given, true_end(scene, ends), self._force_peak)

    def _observe(self, answer: object | None) -> FillObservation:
        seen = self._look()
        force, _ = self.simulator.external_wrench()
        return FillObservation(seen.joints, seen.scene, force, seen.is_held, answer)

    def _look(self) -> PackingObservation:
        """What is known now; the forces count for the peak of the whole job."""
        seen = self.cell.observe()
        self._force_peak = max(self._force_peak, self._forces.note(seen.forces))
        return seen

    def _serve(self, request: FillRequest, on_step: Callable[[FillLockstep], None] | None) -> object:
        match request:
            case Arrange():
                return self._arrange(request)
            case Judge():
                return self._judge()
            case Present(item):
                reason = self.simulator.present(item)
                self.cell.estimator.change_scene(self.simulator.description)
                return Presented(None if reason else self.simulator.description, reason)
            case UsePump(close):
                return self._grip(close=close)
            case Pack():
                return self._pack(request, on_step)

    def _arrange(self, request: Arrange) -> Arrangement:
        state = self.cell.estimator.state(self.simulator.time)
        scene = self.simulator.description
        found = self._planner.plan(scene, state, request.items, self._rng, request.planned)
        self.cell.advance(self._config.placement_latency)
        return found

    def _judge(self) -> str:
        """Why the object that was handed over has no feasible placement; empty if it has one."""
        self.cell.advance(self._config.settle)  # the cameras have to see it
        scene = self.simulator.description
        state = self.cell.estimator.state(self.simulator.time)
        if unseen_of(scene, state) or scene.new_object.name not in state.objects:
            return ""  # it will be looked for
        planner = PlacementPlanners(scene, self._physical, self._config.planner).of("algorithm_1")
        return planner.plan(state, self._rng).reason

    def _grip(self, *, close: bool) -> str:
        if not close:
            self.simulator.release()
            self.cell.estimator.let_go()
            return ""
        if not (reason := self.simulator.grip()):
            self.cell.estimator.take_hold()
        return reason

    def _pack(self, request: Pack, on_step: Callable[[FillLockstep], None] | None) -> Packed:
        """Run a packing goal to its outcome."""
        scene, config = self.simulator.description.gripped(request.grip), self._config
        seed = self._seed + 1000 * len(self.job.report.objects)
        placements = LockstepPlacements(
            scene, self._physical, config, self._method.placement_variant, seed, request.X_WN
        )
        session = PackingSession(
            scene, self._physical, config.session.of_goals(), PackingMethod.PACK_IT_IN, self.simulator.time
        )
        for _ in cycles(self.cell, session, placements, config.latency, self._look):
            if on_step is not None:
                on_step(self)
        self.cell.send(hold(self.simulator.joints()))
        assert session.task.outcome is not None
        tried = session.task.tried
        return Packed(session.task.outcome, tried[-1] if tried else None)
