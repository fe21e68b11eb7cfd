"""One problem carried out by the simulated arm, and what came of it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from block_fsm.requests import ExecutorRequest
from block_fsm.task import RearrangeTask
from pack_core.blocks.cell import BlocksCell
from pack_core.blocks.planar import PlanarPose
from pack_core.blocks.problem import Problem
from pack_core.states import SceneState
from pack_lockstep.blocks.execution_monitor import ExecutionMonitor
from pack_lockstep.blocks.lockstep import BlocksLockstep, BlocksLockstepConfig
from pack_lockstep.blocks.planning import CountedPlanner, CountedPlannerConfig

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
    task = RearrangeTask(problem.goals, problem.workspace, problem.side, problem.symmetry, problem.gripper)
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
