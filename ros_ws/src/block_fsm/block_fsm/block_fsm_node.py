"""The executor as a ROS 2 node: action `/rearrange` in; moves, grips, pictures and plans asked for."""

from __future__ import annotations

import json
import threading
from typing import Any

import numpy as np
from pack_interfaces.action import Rearrange
from pack_interfaces.msg import RearrangeStatus
from pydantic import Field
from std_msgs.msg import String

from block_fsm.executor import Executor
from block_fsm.executor_config import ExecutorConfig, RequestTimeouts
from block_fsm.motions import Motions, TableObstacles
from block_fsm.outcome import ExitReason, Outcome
from block_fsm.requests import Answer, ExecutorRequest
from block_fsm.ros.request_runner import RequestRunner
from block_fsm.task import RearrangeTask
from pack_core.blocks.cell import blocks_cell
from pack_core.blocks.gripper import FingerStatus
from pack_core.blocks.model import TOOL, arm_model
from pack_core.blocks.problem_file import parse_problem
from pack_core.kinematics.chain import chain_from_model
from pack_core.robots.ur10e import JOINTS
from pack_core.ros.contracts import blocks as contracts
from pack_core.ros.contracts import motion
from pack_core.ros.goal_node import GoalNode
from pack_core.ros.messages.blocks import to_action
from pack_core.ros.messages.conversions import to_stamp
from pack_core.ros.messages.markers import goal_markers
from pack_core.ros.run import run_node
from pack_core.tasks.steps import TaskRun

SHUT = 0.002
"""Fingers that are no farther apart press on each other and hold nothing [m]."""


class BlockFsmNodeConfig(ExecutorConfig):
    """Parameters of the node `fsm` of the blocks cell."""

    patience: RequestTimeouts = RequestTimeouts()
    watched: tuple[str, ...] = Field(
        default=("sim", "tags", "rearrangement", "motion", "recorder"),
        description="a goal ends when one of them stays silent",
    )
    fault_time: float = Field(default=2.0, gt=0, description="silence that ends a goal [s of wall clock]")


class BlockFsmNode(GoalNode):
    """Carries out one rearrangement at a time."""

    def __init__(self, **kwargs: Any) -> None:
        super().__init__("fsm", **kwargs)
        self._config = self.read_parameters(BlockFsmNodeConfig, self._change)
        self._cell = blocks_cell()
        self._chain = chain_from_model(arm_model(self._cell), JOINTS, TOOL)
        self._executor: Executor | None = None
        self._pending: TaskRun[Answer] | None = None
        self._request: Rearrange.Goal | None = None
        self._start = 0.0
        self._stepping = threading.Lock()
        self._runner = RequestRunner(self, self._config.patience, self._step, self._on_refusal)
        self._status = self.advertise(contracts.STATUS)
        self._result = self.advertise(contracts.RESULT)
        self._goals = self.advertise(motion.GOAL_MARKERS)
        self.take_goals(contracts.REARRANGE, self._config.watched, self._config.fault_time)

    def _change(self, config: BlockFsmNodeConfig) -> None:
        """Use these parameters from the next goal on."""
        self._config = config

    def destroy_node(self) -> None:
        """Step no more, then end."""
        self._runner.end()
        super().destroy_node()

    @property
    def waits_for(self) -> str:
        if self._runner.motion is None or self._runner.fingers is None:
            return "nothing heard of arm and gripper yet: are sim and motion up?"
        return ""

    def refusal(self, request: Rearrange.Goal) -> str:
        if not request.problem.strip():
            return (
                "the goal's `problem` is empty; allowed: a problem file's text (docs/cells/blocks/manual.md)"
            )
        parse_problem(request.problem, "goal", self._cell, goals_only=True)  # raises when it is no problem
        fingers = self._runner.fingers
        if fingers is not None and fingers.status is FingerStatus.HOLDING and fingers.opening > SHUT:
            return (
                f"the fingers hold something {1000 * fingers.opening:.0f} mm wide, as after a stop in the "
                f"middle of a goal; support it and call {contracts.JAW_COMMAND.name} with an opening of "
                "0.085, or reset the cell"
            )
        return self.waits_for

    async def pursue(self, request: Rearrange.Goal) -> Rearrange.Result:
        """Follow the executor from request to request until it has an outcome."""
        self._request, self._start = request, self._runner.time
        try:
            executor = self._make(request)
            with self._stepping:
                self._executor = executor
                self._next(executor.start())
            await self.until_goal_ends()
        finally:
            self._executor = None
        assert executor.outcome is not None
        result = _to_result(executor.outcome, self._runner.time - self._start)
        # With the problem, a recording of the goal can be evaluated without any file beside it.
        self._result.publish(String(data=json.dumps({**_plain(result), "problem": request.problem})))
        return result

    def describe(self, result: Rearrange.Result) -> str:
        return f"{result.exit_reason}: {result.message}"

    def _make(self, request: Rearrange.Goal) -> Executor:
        problem = parse_problem(request.problem, "goal", self._cell, goals_only=True)
        task, sizes = RearrangeTask.of(problem), problem.sizes
        self._goals.publish(goal_markers({
            name: (np.array(sizes[name]), goal.pose(0.5 * sizes[name].z))
            for name, goal in problem.goals.items()
        }))  # fmt: skip
        view = np.array(self._cell.robot.look)
        motions = Motions(self._config, task.sizes, task.gripper, view, self._chain.forward(view))
        obstacles = TableObstacles(self._cell, task.sizes)
        return Executor(task, self._config, motions, obstacles, self._cell.gripper.force)

    def _step(self) -> None:
        """With every status of the motion, in its thread: look whether what was asked for is done."""
        with self._stepping:
            executor = self._executor
            if executor is None or self._pending is None:
                return
            if self.is_cancel_requested:
                self._end(ExitReason.CANCELED, "on request")
                return
            self._pending.go_on()
            if self._pending.failure:
                self._end(ExitReason.MOTION_FAILED, self._pending.failure)
            elif self._pending.is_over:
                self._next(executor.answer(self._pending.outcome))

    def _next(self, request: ExecutorRequest | None) -> None:
        executor, given = self._executor, self._request
        assert executor is not None
        assert given is not None
        self._status.publish(_to_status(executor, self._runner.time))
        self.publish_feedback(_to_feedback(executor, self._runner.time - self._start))
        if request is None:
            self._pending = None
            self.end_goal()
            return
        self._pending = TaskRun(self._runner.steps(request, given.method, given.seed))
        self._pending.go_on()

    def _cancel(self, reason: ExitReason, message: str) -> None:
        with self._stepping:
            self._end(reason, message)

    def _end(self, reason: ExitReason, message: str) -> None:
        if self._executor is None or self._executor.outcome is not None:
            return
        self._runner.stop()
        self._executor.cancel(reason, message)
        self._next(None)

    def _on_refusal(self, reason: str) -> None:
        self.health.count("refused command", reason)
        self.get_logger().error(reason)

    def on_lost_peers(self, peers: list[str]) -> None:
        self._cancel(ExitReason.NODE_SILENT, f"node '{peers[0]}' is silent")

    def on_arm_stop(self, reason: str) -> None:
        self._cancel(ExitReason.ARM_STOPPED, reason)

    def give_up(self) -> None:
        with self._stepping:  # no step may send a target after the stop
            self._executor = None
            self._runner.stop()


def _to_status(executor: Executor, time: float) -> RearrangeStatus:
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


def _to_feedback(executor: Executor, elapsed: float) -> Rearrange.Feedback:
    """Where a rearrangement stands, for the client of the action."""
    return Rearrange.Feedback(
        phase=executor.phase.value, block=executor.action.block if executor.action else "",
        done=executor.done, actions=len(executor.plan.actions) if executor.plan else 0, elapsed=elapsed,
    )  # fmt: skip


def _to_result(outcome: Outcome, elapsed: float) -> Rearrange.Result:
    """The result of the action, from how the rearrangement ended."""
    tally = outcome.tally
    return Rearrange.Result(
        success=outcome.success, exit_reason=outcome.exit_reason.value, message=outcome.message,
        picks=tally.picks, pushes=tally.pushes, plans=tally.plans, failed_grasps=tally.failed_grasps,
        deviations=tally.deviations, disturbances=tally.disturbances, refusals=tally.refusals,
        position_error=float(outcome.position_error), yaw_error=float(outcome.yaw_error),
        execution_time=elapsed,
    )  # fmt: skip


def _plain(result: Rearrange.Result) -> dict[str, Any]:
    return {name: getattr(result, name) for name in result.get_fields_and_field_types()}


def main() -> int:
    """Entry point of `block_fsm_node`."""
    return run_node(BlockFsmNode)
