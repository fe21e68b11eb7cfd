"""Sends the packing goal to a running cell and follows it to its end."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from typing import Any

import rclpy
from pack_interfaces.action import PackObject
from pydantic import Field, NonNegativeFloat
from rclpy.action import ActionClient
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.signals import SignalHandlerOptions
from rclpy.task import Future

from pack_core.config import Config
from pack_core.errors import PackError
from pack_core.ros.cell_node import CellNode
from pack_core.ros.contracts import packing as contracts
from pack_core.ros.contracts import shared
from pack_core.ros.params import read_parameters

PEERS = ("sim", "perception", "planner", "mpc", "recorder")
RETRY = 0.5
"""Wall clock [s] between two tries while the controller still refuses the goal."""


SETTLE = 1.0
"""Wall clock [s] for which all nodes are up before the goal is sent, so that all hear each other."""


class GoalConfig(Config):
    """The goal."""

    method: str = Field(default="pack_it_in", description="pack_it_in, uninformed_pose or uninformed_physics")
    seed: int = Field(default=0, ge=0, description="of the placement planner's samples")
    timeout: NonNegativeFloat = Field(default=0.0, description="simulated [s]; 0: that of the controller")


class GoalNode(CellNode):
    """One goal: sent again until it is accepted, then followed.

    Attributes:
        is_accepted: whether the controller has taken the goal.
        feedback: the newest, if any.
        result: once the goal has ended.
        real_time_factor: as the simulator reports it.
    """

    def __init__(self, goal: GoalConfig | None = None, **kwargs: Any) -> None:
        super().__init__("goal", **kwargs)
        self._goal = goal or read_parameters(self, GoalConfig)
        self.is_accepted = False
        self.feedback: PackObject.Feedback | None = None
        self.result: PackObject.Result | None = None
        self.real_time_factor = 0.0
        self._client = ActionClient(self, contracts.PACK_OBJECT.type, contracts.PACK_OBJECT.name)
        self._is_sent = False
        self._next_try = 0.0
        self._is_complete = False
        self.listen(shared.REAL_TIME_FACTOR, self._on_real_time_factor)

    @property
    def missing(self) -> list[str]:
        """Nodes of the cell that are not up."""
        return [peer for peer in PEERS if not self.count_publishers(f"/alive/{peer}")]

    def pursue(self) -> None:
        """Send the goal if it is not on its way; to be called again and again."""
        if self._is_sent or self.missing:
            return
        if not self._is_complete:
            self._is_complete, self._next_try = True, time.monotonic() + SETTLE
        if time.monotonic() >= self._next_try and self._client.server_is_ready():
            goal = PackObject.Goal(**self._goal.model_dump())
            self._is_sent = True
            future = self._client.send_goal_async(goal, feedback_callback=self._on_feedback)
            future.add_done_callback(self._on_answer)

    def _on_answer(self, future: Future) -> None:
        handle = future.result()
        self.is_accepted = self._is_sent = handle.accepted
        self._next_try = time.monotonic() + RETRY
        if handle.accepted:
            handle.get_result_async().add_done_callback(self._on_result)

    def _on_feedback(self, message: Any) -> None:
        self.feedback = message.feedback

    def _on_result(self, future: Future) -> None:
        self.result = future.result().result

    def _on_real_time_factor(self, message: Any) -> None:
        self.real_time_factor = message.data


def follow_goal(
    goal: GoalConfig | None,
    on_turn: Callable[[GoalNode], None],
    *,
    domain: int | None = None,
    linger: float = 0.0,
) -> PackObject.Result:
    """Send a goal and wait for its result, leaving signals to the caller.

    Args:
        goal: what to do; the node's parameters if None.
        on_turn: is called about ten times a second of wall clock; what it raises ends the wait.
        domain: ROS domain; the environment's if None.
        linger: wall clock to stay after the result, so that the end is recorded [s].
    """
    rclpy.init(domain_id=domain, signal_handler_options=SignalHandlerOptions.NO)
    executor, node = SingleThreadedExecutor(), None
    try:
        node = GoalNode(goal)
        executor.add_node(node)
        while node.result is None:
            _turn(executor, node, on_turn)
        end = time.monotonic() + linger
        while time.monotonic() < end:
            _turn(executor, node, on_turn)
        return node.result
    finally:
        executor.shutdown()
        if node is not None:
            node.destroy_node()
        rclpy.try_shutdown()


def _turn(executor: SingleThreadedExecutor, node: GoalNode, on_turn: Callable[[GoalNode], None]) -> None:
    end = time.monotonic() + 0.1
    while (rest := end - time.monotonic()) > 0.0:
        executor.spin_once(timeout_sec=rest)
    node.pursue()
    on_turn(node)


def main() -> int:
    """Send one goal to the cell that is running; 0 if the object was packed."""
    try:
        result = follow_goal(None, lambda node: None)
    except PackError as error:
        sys.stderr.write(f"error: {error}\n")
        return 2
    except (KeyboardInterrupt, ExternalShutdownException):
        return 1
    sys.stdout.write(f"{result.exit_reason}: {result.message}\n")
    return 0 if result.success else 1
