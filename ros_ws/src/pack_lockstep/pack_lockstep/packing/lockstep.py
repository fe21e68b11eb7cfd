"""The packing cell in one process, without ROS, on simulated time.

It composes the same cores as the nodes. Planning takes a configured time on the simulated clock, whatever it
takes on the wall clock, so a run repeats bit for bit on any machine.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from pack_core.packing.cell import PackingCell
from pack_core.packing.goals import PackingMethod
from pack_core.packing.markers import MarkerFrame
from pack_core.packing.scene import Scene
from pack_core.states import SceneState
from pack_evaluation.packing.run import Run
from pack_lockstep.packing.lockstep_cell import LockstepCell, LockstepPlacements
from pack_lockstep.packing.lockstep_config import LockstepConfig
from pack_lockstep.packing.run_log import PackingRunLog
from pack_mpc.controller import ControlPlan
from pack_mpc.observation import PackingObservation, blind_for
from pack_mpc.session import PackingSession
from pack_mpc.task.task import PackingOutcome
from pack_planner.placement.placement_planner import PlacementPlanners

HELD = "HELD"
"""What a cycle is called in which the arm holds."""


@dataclass(frozen=True)
class Step:
    """One cycle of the loop, for logs: time [s], stage, observation, true state and plan."""

    time: float
    stage: str
    distance: float
    seen: PackingObservation
    truth: SceneState
    plan: ControlPlan | None


class Lockstep:
    """Runs one scene from start to outcome.

    Args:
        cell: the cell's physical facts.
        scene: the scene, with a pose for every object.
        config: parameters.
        method: PackItIn or a baseline.
        seed: seed of the sensors' noise and of the placements.
    """

    def __init__(
        self, cell: PackingCell, scene: Scene, config: LockstepConfig, method: PackingMethod, seed: int
    ) -> None:
        self._config, self._log = config, PackingRunLog()
        self._cell = LockstepCell(cell, scene, config, seed, self._log.sense)
        self.simulator = self._cell.simulator
        description = self.simulator.description
        planners = PlacementPlanners(description, cell, config.planner)
        self._placements = LockstepPlacements(planners.of(method.placement_variant), config, seed)
        self._cell.settle()
        self._start = self.simulator.time
        self.session = PackingSession(description, cell, config.session, method, self._start)

    def deceive(self, cameras: Callable[[MarkerFrame], MarkerFrame]) -> None:
        """Deliver other frames of markers from now on than the cameras take."""
        self._cell.cameras = cameras

    def run(self, on_step: Callable[[Step], None] | None = None) -> PackingOutcome:
        """Run to the outcome; `on_step` is called in every cycle."""
        session = self.session
        while session.task.outcome is None:
            seen = self._cell.observe()
            if blind_for(seen.scene, seen.joints.time) > session.blind_time:
                self._wait(seen, on_step)
                continue
            if (placement := self._placements.serve(session, seen)) is not None:
                self._log.place(placement)
            plan = session.step(seen, self._config.latency)
            if plan is not None:
                self._log.iterate(session.task, seen.joints.time, plan)
            if on_step is not None:
                stage = session.task.machine.stage.name if session.task.machine else "IDLE"
                on_step(
                    Step(seen.joints.time, stage, session.task.distance, seen, self.simulator.truth(), plan)
                )
            self._cell.advance(self._config.latency)
            if plan is not None:
                self.simulator.accept(plan.setpoints)
        return session.task.outcome

    def _wait(self, seen: PackingObservation, on_step: Callable[[Step], None] | None) -> None:
        """Plan nothing for a cycle, as the node does while the cameras see nothing: the driver brakes."""
        self.session.task.expire(seen.joints.time)
        if on_step is not None:
            distance = self.session.task.distance
            on_step(Step(seen.joints.time, HELD, distance, seen, self.simulator.truth(), None))
        self._cell.advance(self._config.latency)

    def recorded(self) -> Run:
        """The run in the form in which recordings are evaluated.

        Raises:
            ValueError: the run has not ended yet.
        """
        outcome = self.session.task.outcome
        if outcome is None:
            raise ValueError("the run has not ended; call run() first")
        simulator = self.simulator
        return self._log.to_run(
            self.session.scene, self._start, outcome, simulator.pump.state.release_reason,
            simulator.cell.robot.model,
        )  # fmt: skip
