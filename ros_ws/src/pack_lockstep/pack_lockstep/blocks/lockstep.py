"""The blocks cell in one process, without ROS, on simulated time.

It composes the same cores as the nodes. Pictures and plans take a stated time on the simulated clock,
never the wall clock, so a run repeats bit for bit on any machine.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
from pydantic import Field, NonNegativeFloat, PositiveFloat

from block_fsm.executor import Executor
from block_fsm.executor_config import ExecutorConfig, RequestTimeouts
from block_fsm.motions import Motions, TableObstacles
from block_fsm.outcome import ExitReason, Outcome
from block_fsm.requests import Answer, ExecutorRequest, Look, MoveArm, MoveFingers, NoPicture, PlanFor
from block_fsm.task import RearrangeTask
from pack_core.blocks.cell import BlocksCell
from pack_core.blocks.gripper import FingerState, FingerStatus
from pack_core.blocks.plan import Plan
from pack_core.blocks.planar import PlanarPose
from pack_core.blocks.problem import Problem
from pack_core.config import Config
from pack_core.motion.target import MotionState, MotionStatus, MotionTarget
from pack_core.states import SceneState
from pack_lockstep.driven_arm import DrivenArm
from pack_motion.arm.arm import load_arm
from pack_motion.controller import MotionController
from pack_motion.reference.trajectory import JointState
from pack_motion.tracking.config import motion_set
from pack_perception.tags.tag_vision import TagVision, TagVisionConfig
from pack_planner.rearrangement.methods import DEFAULT_METHOD, MethodName, RearrangementConfig
from pack_planner.rearrangement.planning import plan
from pack_sim.blocks.overhead_camera import OverheadCamera
from pack_sim.blocks.simulator import BlocksSimulator, BlocksSimulatorConfig


class CountingClock:
    """A clock that goes on by a step whenever it is read, so that a run repeats on any machine."""

    def __init__(self, step: float) -> None:
        self._step, self._time = step, 0.0

    def __call__(self) -> float:
        """The time [s], a step later at every reading."""
        self._time += self._step
        return self._time


class CountedPlannerConfig(Config):
    """Parameters of planning in lockstep."""

    method: MethodName = DEFAULT_METHOD
    budget: PositiveFloat = Field(default=0.5, description="of a plan, on the counting clock [s]")
    step: PositiveFloat = Field(default=0.005, description="by which that clock goes on [s]")
    seed: int = Field(default=0, ge=0, description="of what the planner draws at random")


class CountedPlanner:
    """Plans with a budget of work.

    Args:
        config: method and budget.
        methods: parameters of the methods.
    """

    def __init__(self, config: CountedPlannerConfig, methods: RearrangementConfig) -> None:
        self._config, self._methods = config, methods

    def __call__(self, problem: Problem) -> Plan:
        """A plan for a problem."""
        config = self._config
        return plan(
            problem, method=config.method, budget_s=config.budget, seed=config.seed,
            config=self._methods, clock=CountingClock(config.step),
        )  # fmt: skip


Planner = Callable[[Problem], Plan]


class BlocksLockstepConfig(Config):
    """Parameters of a run; the parts' own are those of the nodes."""

    period: PositiveFloat = Field(default=0.004, description="between two setpoints for the arm [s]")
    vision_latency: NonNegativeFloat = Field(default=0.1, description="from exposure to the poses [s]")
    planning_latency: NonNegativeFloat = Field(default=0.3, description="a plan takes [s]")
    patience: RequestTimeouts = RequestTimeouts()
    motion: str = Field(default="shipped", description="a set of config/motion")
    shadows: bool = Field(default=False, description="in the pictures")
    simulator: BlocksSimulatorConfig = BlocksSimulatorConfig()
    vision: TagVisionConfig = TagVisionConfig()
    planner: RearrangementConfig = RearrangementConfig()
    executor: ExecutorConfig = ExecutorConfig()


class BlocksLockstep:
    """One rearrangement from start to outcome; a context manager, because it holds a renderer.

    Args:
        cell: the cell's physical facts.
        task: the goals.
        starts: X_WB of every block at the start, by id.
        planner: makes plans.
        config: parameters.
        foreign: X_WB of further blocks on the table, by id; nobody knows their tags.

    Attributes:
        camera_is_silent: whether pictures are asked for in vain.
    """

    def __init__(
        self,
        cell: BlocksCell,
        task: RearrangeTask,
        starts: Mapping[str, PlanarPose],
        planner: Planner,
        config: BlocksLockstepConfig,
        foreign: Mapping[str, PlanarPose] | None = None,
    ) -> None:
        self._cell, self._config, self._planner = cell, config, planner
        tags = {name: number for number, name in enumerate(task.goals)}
        there = {**starts, **(foreign or {})}
        all_tags = {**tags, **{name: len(tags) + k for k, name in enumerate(foreign or {})}}
        self.simulator = BlocksSimulator(cell, all_tags, there, config.simulator, sizes=task.sizes)
        self.camera = OverheadCamera(
            cell, all_tags, config.simulator.timestep, shadows=config.shadows, sizes=task.sizes
        )
        self.camera_is_silent = False
        self._vision = TagVision(config.vision, cell.block, tags, task.sizes)
        arm, q = load_arm("blocks"), np.array(cell.robot.look)
        self.motion = MotionController(arm, motion_set(config.motion), self.simulator.time, q)
        self._arm = DrivenArm(self.motion, self.simulator, q, config.period, self._fail)
        motions = Motions(config.executor, task.sizes, task.gripper, q, arm.chain.forward(q))
        obstacles = TableObstacles(cell, task.sizes)
        self.executor = Executor(task, config.executor, motions, obstacles, cell.gripper.force)
        self._targets = 0
        self._on_step: Callable[[], None] | None = None
        self._on_target: Callable[[JointState, MotionTarget], None] | None = None

    def run(
        self, on_request: Callable[[ExecutorRequest, SceneState], None] | None = None,
        on_step: Callable[[], None] | None = None,
        on_target: Callable[[JointState, MotionTarget], None] | None = None,
    ) -> Outcome:  # fmt: skip
        """Run to the outcome.

        Args:
            on_request: sees what is asked for next, and where the blocks truly are.
            on_step: is called with every setpoint of the arm.
            on_target: sees what the arm is asked for, and the state in which it is.
        """
        self._on_step, self._on_target = on_step, on_target
        with self.camera:
            request: ExecutorRequest | None = self.executor.start()
            while request is not None:
                if on_request is not None:
                    on_request(request, self.simulator.truth())
                request = self.executor.answer(self._answer(request))
        assert self.executor.outcome is not None
        return self.executor.outcome

    def _answer(self, request: ExecutorRequest) -> Answer:
        if isinstance(request, Look):
            self._advance(self._config.patience.exposure_delay)
            if self.camera_is_silent:
                self._advance(self._config.patience.picture)
                return NoPicture("the camera does not answer")
            time, picture = self.simulator.time, self.camera.picture(self.simulator.snapshot())
            self._advance(self._config.vision_latency)
            return self._vision.find(picture, self._cell.camera.pinhole, time)
        if isinstance(request, PlanFor):
            self._advance(self._config.planning_latency)
            return self._planner(request.problem)
        if isinstance(request, MoveArm):
            return self._move(request)
        return self._grip(request)

    def _move(self, request: MoveArm) -> MotionStatus:
        self._targets += 1
        target = request.target(self._targets)
        if self._on_target is not None:
            self._on_target(self.motion.commanded, target)
        self.motion.command(target)
        while self.motion.status().state in (MotionState.MOVING, MotionState.SETTLING):
            self._advance(self._config.period)
        return self.motion.status()

    def _grip(self, request: MoveFingers) -> FingerState:
        self.simulator.fingers.command(request.command)
        end = self.simulator.time + self._config.patience.jaw
        while self.simulator.time < end and self.simulator.finger_state().status is FingerStatus.MOVING:
            self._advance(self._config.period)
        return self.simulator.finger_state()

    def _advance(self, duration: float) -> None:
        """Step everything that runs all the time."""
        for _ in range(round(duration / self._config.period)):
            if self._on_step is not None:
                self._on_step()
            self._arm.advance()

    def _fail(self, detail: str) -> None:
        """A rearrangement whose setpoints the driver refuses is over."""
        self.executor.cancel(ExitReason.MOTION_FAILED, detail)
