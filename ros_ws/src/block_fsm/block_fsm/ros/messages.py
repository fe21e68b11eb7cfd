"""The executor's progress and outcome as messages."""

from __future__ import annotations

from pack_interfaces.action import Rearrange
from pack_interfaces.msg import RearrangeStatus

from block_fsm.executor import Executor
from block_fsm.outcome import Outcome
from pack_core.ros.messages.blocks import to_action
from pack_core.ros.messages.conversions import to_stamp


def to_status(executor: Executor, time: float) -> RearrangeStatus:
    """Where a rearrangement stands at `time` [s]."""
    plan, tally, action = executor.plan, executor.tally, executor.action
    message = RearrangeStatus(
        phase=executor.phase.value, block=action.block if action else "", done=executor.done,
        plan=[to_action(step) for step in plan.actions] if plan else [],
        lower_bound=plan.lower_bound if plan else 0, picks=tally.picks, pushes=tally.pushes,
        plans=tally.plans, failed_grasps=tally.failed_grasps, deviations=tally.deviations,
        disturbances=tally.disturbances, refusals=tally.refusals,
    )  # fmt: skip
    message.header.stamp = to_stamp(time)
    return message


def to_feedback(executor: Executor, elapsed: float) -> Rearrange.Feedback:
    """Where a rearrangement stands, for the client of the action."""
    return Rearrange.Feedback(
        phase=executor.phase.value, block=executor.action.block if executor.action else "",
        done=executor.done, actions=len(executor.plan.actions) if executor.plan else 0, elapsed=elapsed,
    )  # fmt: skip


def to_result(outcome: Outcome, elapsed: float) -> Rearrange.Result:
    """The result of the action, from how the rearrangement ended."""
    tally = outcome.tally
    return Rearrange.Result(
        success=outcome.success, exit_reason=outcome.exit_reason.value, message=outcome.message,
        picks=tally.picks, pushes=tally.pushes, plans=tally.plans, failed_grasps=tally.failed_grasps,
        deviations=tally.deviations, disturbances=tally.disturbances, refusals=tally.refusals,
        position_error=float(outcome.position_error), yaw_error=float(outcome.yaw_error),
        execution_time=elapsed,
    )  # fmt: skip
