"""The arm of the blocks cell is stopped in each part of a pick and a push, in lockstep."""

from __future__ import annotations

import numpy as np
import pytest

from block_fsm.outcome import ExitReason
from block_fsm.requests import ExecutorRequest, Look, MoveArm, MoveFingers, PlanFor
from block_fsm.task import RearrangeTask
from integration.stoppable_arm import StoppableArm, assert_a_stop_is_safe
from pack_core.blocks.cell import blocks_cell
from pack_core.blocks.gripper import FingerStatus
from pack_core.blocks.plan import Plan, PlanStatus, Push
from pack_core.blocks.problem import Problem
from pack_core.robots.ur10e import LIMITS
from pack_core.states import SceneState
from pack_lockstep.blocks.lockstep import BlocksLockstep, CountedPlanner, CountedPlannerConfig
from pack_lockstep.blocks.settings import lockstep_config
from pack_planner.rearrangement.instances import make_instance

WHO = "the test's emergency stop"
IN_REQUEST = 0.1
"""The arm is stopped so long after something was begun [s]."""
GROUPS = [
    (Look, ""), (PlanFor, ""), (MoveArm, "approach"), (MoveFingers, ""), (MoveArm, "lift"), (MoveArm, "up"),
    (MoveArm, "push"),
]  # fmt: skip
"""Kind of a request, and label of a move's first segment: `lift` is with a block, `up` without."""


def one_push(problem: Problem) -> Plan:
    """A plan of one push, which a planner would choose only where there is no room to grasp."""
    block = problem.blocks[0]
    return Plan(PlanStatus.FEASIBLE, (Push(block.id, block.pose, block.pose.moved(0.05, block.pose.yaw)),))


class StopAt:
    """Stops the arm within the first request of a kind.

    Args:
        cell: in lockstep.
        kind: of the request.
        label: of the first segment of a move; empty: any request of the kind.
    """

    def __init__(self, cell: BlocksLockstep, kind: type, label: str) -> None:
        self._cell, self._kind, self._label = cell, kind, label
        self.arm = cell._arm = StoppableArm(cell.motion, cell.simulator, LIMITS)
        self._at = np.inf
        self.was_holding: bool | None = None

    def on_request(self, request: ExecutorRequest, _: SceneState) -> None:
        label = request.path.segments[0].label if isinstance(request, MoveArm) else ""
        if self._at == np.inf and isinstance(request, self._kind) and label == self._label:
            self._at = self._cell.simulator.time + IN_REQUEST

    def on_step(self) -> None:
        if self.was_holding is None and self._cell.simulator.time >= self._at:
            self.was_holding = self.is_holding
            self.arm.stop(WHO)
            self._cell.executor.cancel(ExitReason.ARM_STOPPED, f"the arm was stopped: {WHO}")

    @property
    def is_holding(self) -> bool:
        return self._cell.simulator.finger_state().status is FingerStatus.HOLDING


@pytest.mark.parametrize(("kind", "label"), GROUPS, ids=[label or kind.__name__ for kind, label in GROUPS])
def test_a_stopped_arm_stands_keeps_its_block_and_begins_anew_where_it_is(
    compiled: None, kind: type, label: str
) -> None:
    cell = blocks_cell()
    problem = make_instance(2, 0.1, 0, centre=cell.workspace.centre)
    config = lockstep_config()
    planner = one_push if label == "push" else CountedPlanner(CountedPlannerConfig(), config.planner)
    run = BlocksLockstep(cell, RearrangeTask.of(problem), problem.starts, planner, config)
    stop = StopAt(run, kind, label)
    outcome = run.run(stop.on_request, stop.on_step)
    assert stop.was_holding is not None, "nothing of this kind was asked for"
    assert outcome.exit_reason is ExitReason.ARM_STOPPED
    assert WHO in outcome.message
    assert_a_stop_is_safe(stop.arm, run.motion)
    if stop.was_holding or label != "":
        assert stop.is_holding == stop.was_holding
