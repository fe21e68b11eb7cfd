"""The packing cell in one process, without ROS, on simulated time.

It composes the same cores as the nodes. Planning takes a configured time on the simulated clock, whatever it
takes on the wall clock, so a run repeats bit for bit on any machine.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from pydantic import Field, NonNegativeFloat, PositiveFloat

from pack_core.config import Config
from pack_core.joints import JointSample
from pack_core.packing.cell import PackingCell
from pack_core.packing.method import PackingMethod
from pack_core.packing.scene import Scene
from pack_core.packing.topics import JOINT_RATE, WRENCH_RATE
from pack_core.rotations import Array
from pack_core.states import SceneState
from pack_core.topics import steps_between
from pack_evaluation.packing.run import Run
from pack_lockstep.packing.presets import PackingPreset
from pack_lockstep.packing.run_log import PackingRunLog
from pack_mpc.controller import ControlPlan
from pack_mpc.outcome import PackingOutcome
from pack_mpc.session import PackingObservation, PackingSession, SessionConfig
from pack_perception.mocap.estimator_config import EstimatorConfig
from pack_perception.mocap.physics_estimator import PhysicsEstimator
from pack_planner.placement.placement_planner import PlacementPlannerConfig, PlacementPlanners
from pack_planner.placement.placement_result import PlannedPlacement
from pack_sim.packing.simulator import Simulator
from pack_sim.packing.simulator_config import SimulatorConfig


class LockstepConfig(Config):
    """Parameters of a run; those of the parts are the nodes' own parameters."""

    latency: PositiveFloat = Field(
        default=0.048, description="an optimizer iteration takes [s of simulated time]"
    )
    placement_latency: NonNegativeFloat = Field(
        default=0.3, description="Algorithm 1 takes [s of simulated time]"
    )
    rehearsal_latency: NonNegativeFloat = Field(
        default=0.2, description="and so much each round of rehearsals [s of simulated time]"
    )
    settle: PositiveFloat = Field(
        default=0.3, description="before the goal, so that everything has been seen [s]"
    )
    simulator: SimulatorConfig = SimulatorConfig()
    estimator: EstimatorConfig = EstimatorConfig()
    planner: PlacementPlannerConfig = PlacementPlannerConfig()
    session: SessionConfig = SessionConfig()


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
        self._config, self._seed = config, seed
        self._log = PackingRunLog()
        self.simulator = Simulator(cell, scene, config.simulator, np.random.default_rng(seed))
        description = self.simulator.description
        self._estimator = PhysicsEstimator(description, cell, config.estimator)
        planners = PlacementPlanners(description, cell, config.planner)
        self._planner = planners.of(method.placement_variant)
        self._forces: list[float] = []
        self._advance(config.settle)
        self._forces.clear()
        self._start = self.simulator.time
        self.session = PackingSession(description, cell, config.session, method, self._start)
        self._answer: tuple[float, PlannedPlacement] | None = None

    def run(self, on_step: Callable[[Step], None] | None = None) -> PackingOutcome:
        """Run to the outcome; `on_step` is called in every cycle."""
        session = self.session
        while session.task.outcome is None:
            seen = self._observe()
            self._serve_placement(seen)
            plan = session.step(seen, self._config.latency)
            if plan is not None:
                self._log.iterate(session.task, seen.joints.time, plan)
            if on_step is not None:
                stage = session.task.machine.stage.name if session.task.machine else "IDLE"
                on_step(
                    Step(seen.joints.time, stage, session.task.distance, seen, self.simulator.truth(), plan)
                )
            self._advance(self._config.latency)
            if plan is not None:
                self.simulator.accept(plan.setpoints)
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
        return self._log.to_run(
            self.session.scene, self._start, outcome, simulator.pump.state.release_reason,
            simulator.cell.robot.model,
        )  # fmt: skip

    def _advance(self, duration: float) -> None:
        simulator = self.simulator
        timestep = simulator.config.timestep
        joint_steps, wrench_steps = (steps_between(rate, timestep) for rate in (JOINT_RATE, WRENCH_RATE))
        for i in range(1, round(duration / timestep) + 1):
            simulator.step()
            if i % joint_steps == 0:
                self._estimator.advance(simulator.joints())
            if i % wrench_steps == 0:
                self._forces.append(float(np.linalg.norm(simulator.external_wrench()[0])))
            for frame in simulator.mocap.due(simulator.time):
                self._estimator.correct(frame)
            self._log.sense(simulator, self._estimator)

    def _observe(self) -> PackingObservation:
        joints: JointSample = self.simulator.joints()
        forces, self._forces = np.array(self._forces), []
        scene = self._estimator.state(joints.time)
        return PackingObservation(joints, scene, forces, self.simulator.pump.state.is_closed)

    def _serve_placement(self, seen: PackingObservation) -> None:
        """Plan a placement when the task needs one, and hand it over once its planning time has passed."""
        task, time = self.session.task, seen.joints.time
        if self._answer is None and self.session.needs_placement(seen.scene):
            placement = self._plan_placement(seen.scene, task.avoid)
            self._log.place(placement)
            latency = self._config.placement_latency + placement.rounds * self._config.rehearsal_latency
            self._answer = (time + latency, placement)
        if self._answer is not None and time >= self._answer[0]:
            answer, self._answer = self._answer[1], None
            if answer.X_WO is None:
                task.refuse(time, answer.reason)
            else:
                task.place(
                    answer.X_WO, answer.collisions, answer.over, seen.scene, answer.is_rehearsed
                )  # fmt: skip

    def _plan_placement(self, scene: SceneState, avoid: list[Array]) -> PlannedPlacement:
        return self._planner.plan(
            scene, np.random.default_rng(self._seed + len(avoid)), avoid=avoid,
            avoid_radius=self.session.task.avoid_radius, lean=self.session.task.lean,
        )  # fmt: skip


def lockstep_config(preset: PackingPreset | None = None) -> LockstepConfig:
    """The configuration of all nodes from `config/nodes`, with a preset's changes."""
    given = preset or PackingPreset()
    return LockstepConfig(
        simulator=given.parameters("sim", SimulatorConfig),
        estimator=given.parameters("perception", EstimatorConfig),
        planner=given.parameters("planner", PlacementPlannerConfig),
        session=given.parameters("mpc", SessionConfig),
    )
