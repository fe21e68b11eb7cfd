"""The executor as a ROS 2 node: action `/rearrange` in; moves, grips, pictures and plans asked for."""

from __future__ import annotations

import json
import time
from typing import Any

import numpy as np
from pack_interfaces.action import Rearrange
from pydantic import Field
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.action.server import ServerGoalHandle
from rclpy.task import Future
from std_msgs.msg import String

from block_fsm.executor import Executor
from block_fsm.executor_config import ErrandConfig, ExecutorConfig
from block_fsm.motions import Motions
from block_fsm.outcome import ExitReason, Outcome
from block_fsm.requests import Request
from block_fsm.ros.cell_state import CellState
from block_fsm.ros.errand_runner import ErrandRunner
from block_fsm.ros.errands import Errand
from block_fsm.ros.messages import to_feedback, to_result, to_status
from block_fsm.surroundings import Surroundings
from block_fsm.task import RearrangeTask
from pack_core.blocks.cell import blocks_cell
from pack_core.blocks.model import TOOL, arm_model
from pack_core.blocks.problem_file import parse_problem
from pack_core.errors import PackError
from pack_core.kinematics.model_chain import chain_from_model
from pack_core.robots.ur10e import JOINTS
from pack_core.ros.cell_node import CellNode
from pack_core.ros.contracts import blocks as contracts
from pack_core.ros.params import read_parameters
from pack_core.ros.run import run_node
from pack_core.ros.silence import Silence

CHECK_PERIOD = 0.2
"""Between two looks at silent peers [s of wall clock]."""


class BlockFsmNodeConfig(ExecutorConfig):
    """Parameters of the node `fsm` of the blocks cell."""

    patience: ErrandConfig = ErrandConfig()
    watched: tuple[str, ...] = Field(
        default=("sim", "tags", "rearrangement", "motion"),
        description="a goal ends when one of them stays silent",
    )
    fault_time: float = Field(default=2.0, gt=0, description="silence that ends a goal [s of wall clock]")


class BlockFsmNode(CellNode):
    """Carries out one rearrangement at a time."""

    def __init__(self, **kwargs: Any) -> None:
        super().__init__("fsm", **kwargs)
        self._config = read_parameters(self, BlockFsmNodeConfig)
        self._cell = blocks_cell()
        self._chain = chain_from_model(arm_model(self._cell), JOINTS, TOOL)
        self._executor: Executor | None = None
        self._errand: Errand | None = None
        self._goal: ServerGoalHandle | None = None
        self._done: Future | None = None
        self._is_busy, self._start = False, 0.0
        self._silence = Silence()
        self._state = CellState(self, self._step)
        self._runner = ErrandRunner(self, self._state, self._config.patience, self._on_refusal)
        self._status = self.advertise(contracts.STATUS)
        self._result = self.advertise(contracts.RESULT)
        self._action = ActionServer(
            self, contracts.REARRANGE.type, contracts.REARRANGE.name, self._execute,
            goal_callback=self._on_goal, cancel_callback=lambda _: CancelResponse.ACCEPT,
        )  # fmt: skip
        self.watch(self._config.watched, self._on_peer)
        self.create_timer(CHECK_PERIOD, self._judge_silence, clock=self.wall)

    def destroy_node(self) -> None:
        """Take no more goals, then end."""
        self._action.destroy()
        super().destroy_node()

    def _on_goal(self, request: Rearrange.Goal) -> GoalResponse:
        try:
            self._check(request)
        except PackError as error:
            self.health.count("refused goal", str(error))
            self.get_logger().error(f"refused goal: {error}")
            return GoalResponse.REJECT
        self._is_busy = True
        return GoalResponse.ACCEPT

    def _check(self, request: Rearrange.Goal) -> None:
        parse_problem(request.problem, "goal")
        if self._is_busy:
            raise PackError("a rearrangement is in progress; cancel it first")
        if self._silence:
            raise PackError(f"silent: {self._silence}")
        if self._state.motion is None or self._state.jaw is None:
            raise PackError("nothing heard of arm and gripper yet: are sim and motion up?")

    async def _execute(self, goal: ServerGoalHandle) -> Rearrange.Result:
        try:
            outcome = await self._pursue(goal)
        finally:
            self._executor, self._is_busy = None, False
        result = to_result(outcome, self._state.time - self._start)
        self._result.publish(String(data=json.dumps(_plain(result))))
        self.get_logger().info(f"{result.exit_reason}: {result.message}")
        if goal.is_cancel_requested:
            goal.canceled()
        elif result.success:
            goal.succeed()
        else:
            goal.abort()
        return result

    async def _pursue(self, goal: ServerGoalHandle) -> Outcome:
        self._goal, self._start = goal, self._state.time
        self._done = Future(executor=self.executor)
        self._executor = executor = self._make(goal.request)
        self._next(executor.start())
        await self._done
        assert executor.outcome is not None
        return executor.outcome

    def _make(self, request: Rearrange.Goal) -> Executor:
        problem = parse_problem(request.problem, "goal")
        task = RearrangeTask(
            problem.goals, problem.workspace, self._cell.block.edge, problem.symmetry, problem.gripper
        )
        look = np.array(self._cell.robot.look)
        motions = Motions(self._config, task.side, task.gripper, look, self._chain.forward(look))
        surroundings = Surroundings(self._cell, task.side)
        return Executor(task, self._config, motions, surroundings, self._cell.gripper.force)

    def _step(self) -> None:
        """With every status of the motion: look whether what was asked for is done."""
        executor, goal = self._executor, self._goal
        if executor is None or goal is None or self._errand is None:
            return
        if goal.is_cancel_requested:
            self._cancel(ExitReason.CANCELLED, "on request")
            return
        answer = self._errand.poll(self._state)
        if answer is not None:
            self._next(executor.answer(answer))

    def _next(self, request: Request | None) -> None:
        executor, goal = self._executor, self._goal
        assert executor is not None
        assert goal is not None
        assert self._done is not None
        self._status.publish(to_status(executor, self._state.time))
        goal.publish_feedback(to_feedback(executor, self._state.time - self._start))
        if request is None:
            self._errand = None
            self._done.set_result(None)
            return
        given = goal.request
        self._errand = self._runner.begin(request, given.method, given.seed)

    def _cancel(self, reason: ExitReason, message: str) -> None:
        if self._executor is None or self._done is None or self._done.done():
            return
        self._runner.stop()
        self._executor.cancel(reason, message)
        self._next(None)

    def _on_refusal(self, reason: str) -> None:
        self.health.count("refused command", reason)
        self.get_logger().error(reason)

    def _on_peer(self, peer: str, is_alive: bool) -> None:
        self._silence.note(peer, is_alive, time.monotonic())

    def _judge_silence(self) -> None:
        if lost := self._silence.lasting(self._config.fault_time, time.monotonic()):
            self._cancel(ExitReason.NODE_SILENT, f"node '{lost[0]}' is silent")


def _plain(result: Rearrange.Result) -> dict[str, Any]:
    return {name: getattr(result, name) for name in result.get_fields_and_field_types()}


def main() -> int:
    """Entry point of `block_fsm_node`."""
    return run_node(BlockFsmNode)
