"""The packing cell in one process, without ROS, on simulated time.

It composes the same cores as the nodes. Planning takes a configured time on the simulated clock, whatever it
takes on the wall clock, so a run repeats bit for bit on any machine.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from pack_core.errors import MessageError
from pack_core.joints import JointSample, Setpoints
from pack_core.packing.cell import PackingCell, Perception
from pack_core.packing.goals import PackingMethod
from pack_core.packing.markers import MarkerFrame
from pack_core.packing.scene import Scene
from pack_core.packing.topics import JOINT_RATE, WRENCH_RATE
from pack_core.rotations import Array, Pose
from pack_core.states import SceneState
from pack_core.topics import steps_between
from pack_evaluation.packing.run import Run, SeenScene
from pack_evaluation.packing.seen_objects import seen_objects, with_true_names
from pack_lockstep.packing.lockstep_config import LockstepConfig
from pack_lockstep.packing.run_log import PackingRunLog
from pack_mpc.controller import ControlPlan
from pack_mpc.observation import PackingObservation, blind_for
from pack_mpc.session import PackingSession
from pack_mpc.task.task import PackingOutcome
from pack_perception.mocap.hand_over_estimator import HandOverEstimator
from pack_planner.placement.placement_planner import PlacementPlanners
from pack_planner.placement.placement_result import PlannedPlacement
from pack_sim.packing.simulator import Simulator

if TYPE_CHECKING:
    from pack_lockstep.packing.depth_link import DepthLink

Sense = Callable[[Simulator, HandOverEstimator], None]


class LockstepCell:
    """Simulator and estimator, as the nodes `sim` and `perception` run them.

    Args:
        cell: the cell's physical facts.
        scene: the scene, with a pose for every object.
        config: parameters.
        seed: seed of the sensors' noise.
        sense: called after every step of the physics.

    Attributes:
        cameras: makes of each frame of markers the one that is delivered.
    """

    def __init__(
        self, cell: PackingCell, scene: Scene, config: LockstepConfig, seed: int, sense: Sense
    ) -> None:
        self._config, self._sense = config, sense
        self.simulator = Simulator(cell, scene, config.simulator, np.random.default_rng(seed))
        description = self.simulator.description
        self.estimator = HandOverEstimator(description, cell, config.estimator)
        self._depth: DepthLink | None = None
        if cell.perception is Perception.DEPTH:
            # Here: results by markers do not depend on code that they never load.
            from pack_lockstep.packing.depth_link import DepthLink

            self._depth = DepthLink.of(description, cell, config.estimator, seed)
            self.estimator = self._depth.estimator
        self._forces: list[Array] = []
        self.cameras: Callable[[MarkerFrame], MarkerFrame] = lambda frame: frame

    def settle(self) -> None:
        """Let time pass before a goal, so that everything has been seen."""
        self.advance(self._config.settle)
        self._forces.clear()

    def advance(self, duration: float) -> None:
        """Let `duration` pass [s]."""
        simulator, estimator = self.simulator, self.estimator
        timestep = simulator.config.timestep
        joint_steps, wrench_steps = (steps_between(rate, timestep) for rate in (JOINT_RATE, WRENCH_RATE))
        for i in range(1, round(duration / timestep) + 1):
            simulator.step()
            if i % joint_steps == 0:
                estimator.advance(simulator.joints())
            if i % wrench_steps == 0:
                self._forces.append(simulator.external_wrench()[0])
            frames = simulator.mocap.due(simulator.time)
            if self._depth is not None:
                self._depth.step(simulator)
            else:
                for frame in frames:
                    estimator.correct(self.cameras(frame))
            self._sense(simulator, estimator)

    @property
    def known_scene(self) -> Scene:
        """What planner and controller may know: the description, or what was seen of unknown objects."""
        return self.simulator.description if self._depth is None else self._depth.estimator.scene

    def seen(self) -> SeenScene:
        """What perception knows now, matched to what is there."""
        estimate, truth = self.estimator.state(self.estimator.time), self.simulator.truth()
        deviations = {} if self._depth is None else self._depth.estimator.deviations
        return seen_objects(
            self.known_scene, estimate.poses(), self.simulator.scene, truth.poses(), deviations
        )

    def send(self, setpoints: Setpoints) -> None:
        """Hand setpoints to the driver; refused ones leave the arm braking, as in the running cell."""
        with suppress(MessageError):
            self.simulator.accept(setpoints)

    def observe(self) -> PackingObservation:
        """What is known now, with the forces since the last call."""
        simulator = self.simulator
        joints: JointSample = simulator.joints()
        forces, self._forces = np.array(self._forces).reshape(-1, 3), []
        scene = self.estimator.state(joints.time)
        return PackingObservation(joints, scene, forces, simulator.pump.state.is_closed, simulator.zeroed)


class LockstepPlacements:
    """Plans a placement when a goal needs one, and hands it over once its planning time has passed.

    Args:
        scene: the goal's scene, as it is known at first.
        cell: the cell's physical facts.
        config: how placements are planned, and how long that takes.
        variant: of the planner; empty: the configured one.
        seed: seed of the placements.
        near: where the first placement is wanted, X_WN; None: wherever it disturbs least.

    Raises:
        PackError: the new object does not fit into the container.
    """

    def __init__(
        self, scene: Scene, cell: PackingCell, config: LockstepConfig, variant: str, seed: int,
        near: Pose | None = None,
    ) -> None:  # fmt: skip
        self._cell, self._config, self._variant, self._seed, self._near = cell, config, variant, seed, near
        self._answer: tuple[float, PlannedPlacement] | None = None
        self.follow(scene)

    def follow(self, scene: Scene) -> None:
        """Plan in the scene as it is known now."""
        planners = PlacementPlanners(scene, self._cell, self._config.planner)
        self._planner = planners.of(self._variant)

    def serve(self, session: PackingSession, seen: PackingObservation) -> PlannedPlacement | None:
        """Plan if the goal needs a placement, and hand over the last one if it is due.

        Returns:
            A placement that was planned just now.
        """
        task, time, planned = session.task, seen.joints.time, None
        if self._answer is None and session.needs_placement(seen.scene):
            planned = self._planner.plan(
                seen.scene, np.random.default_rng(self._seed + task.answers), avoid=task.avoid,
                avoid_radius=task.avoid_radius, lean=task.lean, near=self._near,
            )  # fmt: skip
            config = self._config
            latency = config.placement_latency + planned.rehearsals * config.rehearsal_latency
            self._answer = (time + latency, planned)
        if self._answer is not None and time >= self._answer[0]:
            answer, self._answer = self._answer[1], None
            if answer.X_WO is None:
                task.refuse(time, answer.reason)
            else:
                task.place(answer.X_WO, answer.collisions, answer.way, seen.scene, answer.is_rehearsed)
        return planned


@dataclass(frozen=True)
class Cycle:
    """One cycle of a goal.

    Attributes:
        seen: what was known.
        placement: that was planned in it, if one was.
        plan: what the driver gets; None where the arm holds, or the goal has ended.
        is_held: whether nothing was planned, so that the driver brakes.
    """

    seen: PackingObservation
    placement: PlannedPlacement | None = None
    plan: ControlPlan | None = None
    is_held: bool = False


def cycles(
    cell: LockstepCell, session: PackingSession, placements: LockstepPlacements, latency: float,
    observe: Callable[[], PackingObservation],
) -> Iterator[Cycle]:  # fmt: skip
    """Pursue a goal to its outcome as the node does, cycle by cycle, each `latency` long [s].

    While the cameras see nothing, or not what the goal needs, nothing is planned: the arm holds, and the goal
    may run out of time. What the driver refuses leaves the arm braking.
    """
    while session.task.outcome is None:
        seen = observe()
        cycle = Cycle(seen, is_held=True)
        if blind_for(seen.scene, seen.joints.time) <= session.blind_time:
            with suppress(MessageError):
                cycle = _planned(cell, session, placements, latency, seen)
        if cycle.is_held:
            session.task.expire(seen.joints.time)
        yield cycle
        cell.advance(latency)
        if cycle.plan is not None:
            cell.send(cycle.plan.setpoints)


def _planned(
    cell: LockstepCell, session: PackingSession, placements: LockstepPlacements, latency: float,
    seen: PackingObservation,
) -> Cycle:  # fmt: skip
    if session.follow(cell.known_scene):
        placements.follow(session.scene)
    placement = placements.serve(session, seen)
    return Cycle(seen, placement, session.step(seen, latency))


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
        self._cell.settle()
        known = self._cell.known_scene
        self._seen = self._cell.seen()
        self._placements = LockstepPlacements(known, cell, config, method.placement_variant, seed)
        self._start = self.simulator.time
        self.session = PackingSession(known, cell, config.session, method, self._start)

    def deceive(self, cameras: Callable[[MarkerFrame], MarkerFrame]) -> None:
        """Deliver other frames of markers from now on than the cameras take."""
        self._cell.cameras = cameras

    def run(self, on_step: Callable[[Step], None] | None = None) -> PackingOutcome:
        """Run to the outcome; `on_step` is called in every cycle."""
        session, cell = self.session, self._cell
        for cycle in cycles(cell, session, self._placements, self._config.latency, cell.observe):
            time, plan = cycle.seen.joints.time, cycle.plan
            if cycle.placement is not None:
                self._log.place(cycle.placement)
            if plan is not None:
                self._log.iterate(session.task, time, plan)
            if on_step is not None:
                stage = session.task.machine.stage.name if session.task.machine else "IDLE"
                stage = HELD if cycle.is_held else stage
                truth = self.simulator.truth()
                on_step(Step(time, stage, session.task.distance, cycle.seen, truth, plan))
        assert session.task.outcome is not None
        return session.task.outcome

    def recorded(self) -> Run:
        """The run in the form in which recordings are evaluated.

        Raises:
            ValueError: the run has not ended yet.
        """
        outcome = self.session.task.outcome
        if outcome is None:
            raise ValueError("the run has not ended; call run() first")
        simulator = self.simulator
        run = self._log.to_run(
            self.session.scene, self._start, outcome, simulator.pump.state.release_reason,
            simulator.cell.robot.model,
        )  # fmt: skip
        if simulator.cell.perception is Perception.MOCAP:
            return run
        return replace(with_true_names(run, self._seen, simulator.scene), seen_after=self._cell.seen())
