"""Sends the packing goal to a running cell and follows it to its end."""

from __future__ import annotations

import sys
import time
from collections.abc import Iterable
from typing import Any

import rclpy
from pack_interfaces.action import PackObject
from pydantic import Field, NonNegativeFloat
from rclpy.action import ActionClient
from rclpy.executors import SingleThreadedExecutor
from rclpy.task import Future

from pack_core.config import Config
from pack_core.errors import PackError
from pack_core.ros import contracts
from pack_core.ros.cell_node import CellNode
from pack_core.ros.params import read_parameters

PEERS = ("sim", "perception", "planner", "mpc", "recorder")
RETRY = 0.5
"""Wall clock [s] between two tries while the controller still refuses the goal."""


class GoalConfig(Config):
    """The goal."""

    method: str = Field("pack_it_in", description="pack_it_in, uninformed_pose or uninformed_physics")
    seed: int = Field(0, ge=0, description="of the placement planner's samples")
    timeout: NonNegativeFloat = Field(0.0, description="simulated [s]; 0: that of the controller")


class GoalNode(CellNode):
    """One goal: sent again until it is accepted, then followed.

    Attributes:
        feedback: the newest, if any.
        result: once the goal has ended.
        real_time_factor: as the simulator reports it.
    """

    def __init__(self, goal: GoalConfig | None = None, **kwargs: Any) -> None:
        super().__init__("goal", **kwargs)
        self._goal = goal or read_parameters(self, GoalConfig)
        self.feedback: PackObject.Feedback | None = None
        self.result: PackObject.Result | None = None
        self.real_time_factor = 0.0
        self._client = ActionClient(self, contracts.PACK_OBJECT.type, contracts.PACK_OBJECT.name)
        self._handle: Any = None
        self._pending: Future | None = None
        self._next_try = 0.0
        self.listen(contracts.REAL_TIME_FACTOR, self._on_real_time_factor)

    @property
    def is_accepted(self) -> bool:
        """Whether the controller has taken the goal."""
        return self._handle is not None

    def missing(self, peers: Iterable[str] = PEERS) -> list[str]:
        """Nodes that are not up."""
        return [peer for peer in peers if not self.count_publishers(f"/alive/{peer}")]

    def pursue(self) -> None:
        """Send the goal if it is not on its way; to be called again and again."""
        if self._handle or self._pending or time.monotonic() < self._next_try or self.missing():
            return
        if self._client.server_is_ready():
            goal = PackObject.Goal(**self._goal.model_dump())
            self._pending = self._client.send_goal_async(goal, feedback_callback=self._on_feedback)
            self._pending.add_done_callback(self._on_answer)

    def cancel(self) -> None:
        """Ask the controller to give up the goal."""
        if self._handle is not None and self.result is None:
            self._handle.cancel_goal_async()

    def _on_answer(self, future: Future) -> None:
        self._pending, self._next_try = None, time.monotonic() + RETRY
        handle = future.result()
        if handle.accepted:
            self._handle = handle
            handle.get_result_async().add_done_callback(self._on_result)

    def _on_feedback(self, message: Any) -> None:
        self.feedback = message.feedback

    def _on_result(self, future: Future) -> None:
        self.result = future.result().result

    def _on_real_time_factor(self, message: Any) -> None:
        self.real_time_factor = message.data


def main() -> int:
    """Send one goal; 0 if the object was packed."""
    rclpy.init()
    executor, node = SingleThreadedExecutor(), None
    try:
        node = GoalNode()
        executor.add_node(node)
        while rclpy.ok() and node.result is None:
            executor.spin_once(timeout_sec=0.1)
            node.pursue()
        node.get_logger().info(f"goal ended: {node.result}")
        return 0 if node.result and node.result.success else 1
    except PackError as error:
        sys.stderr.write(f"error: {error}\n")
        return 2
    finally:
        executor.shutdown()
        if node is not None:
            node.destroy_node()
        rclpy.try_shutdown()
