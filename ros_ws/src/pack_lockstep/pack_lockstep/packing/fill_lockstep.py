"""A fill job in one process, without ROS, on simulated time: the cores of the nodes, as in `Lockstep`."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from pack_core.packing.arrangement import Arrangement, FillMethod
from pack_core.packing.cell import PackingCell
from pack_core.packing.method import PackingMethod
from pack_core.packing.packing_list import PackingList
from pack_lockstep.packing.lockstep_cell import LockstepCell, LockstepPlacements, Sense
from pack_lockstep.packing.lockstep_config import LockstepConfig
from pack_mpc.filling.fill_job import FillJob, FillObservation
from pack_mpc.filling.fill_report import FillReport
from pack_mpc.filling.requests import Arrange, FillRequest, Grip, Pack, Present, Presented
from pack_mpc.outcome import PackingOutcome
from pack_mpc.session import PackingSession, hold
from pack_planner.filling.fill_planner import FillPlanner
from pack_planner.placement.placement_planner import PlacementPlanners

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
        self.cell = LockstepCell(cell, given.start(cell), config, seed, sense or (lambda *_: None))
        self.simulator = self.cell.simulator
        self._planner = FillPlanner(config.arrangement, method, given.order)
        self._rng = np.random.default_rng([seed, 1])
        self.job = FillJob(given, cell, config.fill, self.simulator.description)
        self.cell.settle()

    def run(self, on_step: Callable[[FillLockstep], None] | None = None) -> FillReport:
        """Run to the end; `on_step` is called after every step of the job and of its goals."""
        answer: object | None = None
        while not self.job.is_done:
            command = self.job.step(self._observe(answer))
            answer = None if command.request is None else self._serve(command.request, on_step)
            if command.setpoints is not None:
                self.simulator.accept(command.setpoints)
            if answer is None:
                self.cell.advance(PERIOD)
            if on_step is not None:
                on_step(self)
        return self.job.report

    def _observe(self, answer: object | None) -> FillObservation:
        seen = self.cell.observe()
        force, _ = self.simulator.external_wrench()
        return FillObservation(seen.joints, seen.scene, force, seen.is_held, answer)

    def _serve(self, request: FillRequest, on_step: Callable[[FillLockstep], None] | None) -> object:
        match request:
            case Arrange(items):
                return self._arrange(items)
            case Present(item):
                reason = self.simulator.present(item)
                self.cell.estimator.change_scene(self.simulator.description)
                return Presented(None if reason else self.simulator.description, reason)
            case Grip(close):
                return self._grip(close=close)
            case Pack():
                return self._pack(request, on_step)

    def _arrange(self, items: tuple) -> Arrangement:
        state = self.cell.estimator.state(self.simulator.time)
        found = self._planner.plan(self.simulator.description, state, items, self._rng)
        self.cell.advance(self._config.placement_latency)
        return found

    def _grip(self, *, close: bool) -> str:
        if not close:
            self.simulator.release()
            self.cell.estimator.let_go()
            return ""
        if not (reason := self.simulator.grip()):
            self.cell.estimator.take_hold()
        return reason

    def _pack(self, request: Pack, on_step: Callable[[FillLockstep], None] | None) -> PackingOutcome:
        """Run a packing goal to its outcome, as `Lockstep.run` does."""
        scene, config = self.simulator.description.gripped(request.grip), self._config
        planner = PlacementPlanners(scene, self._physical, config.planner).of(self._method.placement_variant)
        number = len(self.job.report.objects)
        placements = LockstepPlacements(planner, config, self._seed + 1000 * number, request.X_WN)
        session = PackingSession(
            scene, self._physical, config.session, PackingMethod.PACK_IT_IN, self.simulator.time
        )
        while session.task.outcome is None:
            seen = self.cell.observe()
            placements.serve(session, seen)
            plan = session.step(seen, config.latency)
            self.cell.advance(config.latency)
            if plan is not None:
                self.simulator.accept(plan.setpoints)
            if on_step is not None:
                on_step(self)
        self.simulator.accept(hold(self.simulator.joints()))
        return session.task.outcome
