"""One problem carried out by the simulated arm, and what came of it and of every block."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from block_fsm.requests import ExecutorRequest, Look, MoveArm, MoveFingers
from block_fsm.task import RearrangeTask
from pack_core.blocks.cell import BlocksCell
from pack_core.blocks.planar import PlanarPose
from pack_core.blocks.problem import Problem
from pack_core.rotations import Pose, angle_between
from pack_core.states import SceneState
from pack_lockstep.blocks.lockstep import (
    BlocksLockstep,
    BlocksLockstepConfig,
    CountedPlanner,
    CountedPlannerConfig,
)


@dataclass(frozen=True)
class Slip:
    """How far a block moved in the hand between being lifted and being let go [m, rad]."""

    distance: float
    angle: float


class ExecutionMonitor:
    """Is shown every request before it is carried out.

    Attributes:
        slips: of every block that was carried.
        disturbance: farthest that a block was moved by an action on another one [m].
    """

    def __init__(self) -> None:
        self.slips: list[Slip] = []
        self.disturbance = 0.0
        self._before: dict[str, PlanarPose] = {}
        self._carried: tuple[str, Pose] | None = None

    def on_request(self, request: ExecutorRequest, truth: SceneState, X_WT: Pose, block: str) -> None:
        """Note what a request is about to change.

        Args:
            request: what is about to be carried out.
            truth: where the blocks are.
            X_WT: where the tool is.
            block: that the action under way is on; empty between actions.
        """
        if isinstance(request, MoveArm) and request.path.segments[0].label == "lift":
            self._carried = (block, X_WT.inverse() @ truth.objects[block].X_WO)
        elif isinstance(request, MoveFingers) and self._carried is not None:
            self._note_slip(truth, X_WT)
        elif isinstance(request, Look):
            self._note_bystanders({name: PlanarPose.of(o.X_WO) for name, o in truth.objects.items()}, block)

    def _note_slip(self, truth: SceneState, X_WT: Pose) -> None:
        assert self._carried is not None
        (block, X_TB), self._carried = self._carried, None
        now = X_WT.inverse() @ truth.objects[block].X_WO
        distance = float(np.linalg.norm(now.p - X_TB.p))
        self.slips.append(Slip(distance, float(angle_between(now.q, X_TB.q))))

    def _note_bystanders(self, now: dict[str, PlanarPose], moved: str) -> None:
        for name, pose in self._before.items():
            if name != moved:
                self.disturbance = max(self.disturbance, pose.distance_to(now[name]))
        self._before = now


MAX_ERROR, MAX_ANGLE_DEG = 0.0015, 1.5
"""Of a block from its goal, for an execution to count as a success [m]."""
MAX_DISTURBANCE = 0.001
"""Of a block that an action is not on [m]."""
MAX_SLIP, MAX_SLIP_ANGLE_DEG = 0.0002, 0.2
"""In the hand; more of it makes an execution tell nothing about the plan [m]."""


@dataclass(frozen=True)
class Execution:
    """Measures of one execution, from the simulator's truth but for `exit_reason` and the counts.

    Attributes:
        exit_reason: how the executor says it ended.
        message: the same in words.
        picks: blocks picked and placed.
        pushes: blocks pushed.
        plans: plans asked for.
        error_mm: largest distance of a block from its goal.
        angle_deg: largest turn of a block from its goal.
        disturbance_mm: farthest that an action moved a block it was not on.
        slip_mm: farthest that a block moved in the hand.
        slip_deg: farthest that a block turned in the hand.
        duration_s: simulated.
    """

    exit_reason: str
    message: str
    picks: int
    pushes: int
    plans: int
    error_mm: float
    angle_deg: float
    disturbance_mm: float
    slip_mm: float
    slip_deg: float
    duration_s: float

    @property
    def is_valid(self) -> bool:
        """Blocks were held well enough for the rest to mean something."""
        return self.slip_mm <= 1000 * MAX_SLIP and self.slip_deg <= MAX_SLIP_ANGLE_DEG

    @property
    def is_ok(self) -> bool:
        """All blocks at their goals, none moved that should have stood still."""
        return (
            self.is_valid
            and self.exit_reason == "arranged"
            and self.error_mm <= 1000 * MAX_ERROR
            and self.angle_deg <= MAX_ANGLE_DEG
            and self.disturbance_mm <= 1000 * MAX_DISTURBANCE
        )


def execute(
    problem: Problem, cell: BlocksCell, planner: CountedPlannerConfig, config: BlocksLockstepConfig
) -> Execution:
    """Carry out a problem in lockstep."""
    task = RearrangeTask.of(problem)
    lockstep = BlocksLockstep(cell, task, problem.starts, CountedPlanner(planner, config.planner), config)
    monitor = ExecutionMonitor()

    def on_request(request: ExecutorRequest, truth: SceneState) -> None:
        action = lockstep.executor.action
        block = action.block if action is not None else ""
        monitor.on_request(request, truth, lockstep.simulator.tool_pose(), block)

    outcome = lockstep.run(on_request)
    simulator = lockstep.simulator
    poses = {name: PlanarPose.of(state.X_WO) for name, state in simulator.truth().objects.items()}
    error, angle = task.errors(poses)
    slips = monitor.slips
    return Execution(
        outcome.exit_reason.value, outcome.message, outcome.tally.picks, outcome.tally.pushes,
        outcome.tally.plans, 1000 * error, float(np.rad2deg(angle)), 1000 * monitor.disturbance,
        1000 * max((slip.distance for slip in slips), default=0.0),
        float(np.rad2deg(max((slip.angle for slip in slips), default=0.0))), simulator.time,
    )  # fmt: skip
