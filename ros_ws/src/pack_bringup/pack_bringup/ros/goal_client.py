"""Sends a goal to a running cell and follows it to its end."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from typing import Any

import rclpy
from rclpy.action import ActionClient
from rclpy.executors import SingleThreadedExecutor
from rclpy.signals import SignalHandlerOptions
from rclpy.task import Future

from pack_core.ros.cell_node import CellNode
from pack_core.ros.contracts import shared
from pack_core.ros.contracts.contract import Contract

RETRY = 0.5
"""Wall clock [s] between two tries while the goal is still refused."""
SETTLE = 1.0
"""Wall clock [s] for which all nodes are up before the goal is sent, so that all hear each other."""


class GoalClient(CellNode):
    """One goal: sent again until it is accepted, then followed.

    Args:
        contract: the action.
        goal: its message; may be set until it is sent.
        peers: nodes that must be up before it is sent.

    Attributes:
        is_accepted: whether the goal was taken.
        feedback: the newest, if any.
        result: once the goal has ended.
        real_time_factor: as the simulator reports it.
        factors: those reported while the goal was pursued.
        iterations_ms: what the controller's iterations took, where its feedback says so [ms of wall clock].
    """

    def __init__(self, contract: Contract, goal: Any, peers: Sequence[str], **kwargs: Any) -> None:
        super().__init__("goal", **kwargs)
        self.goal, self._peers = goal, peers
        self.is_accepted = False
        self.feedback: Any = None
        self.result: Any = None
        self.real_time_factor = 0.0
        self.factors: list[float] = []
        self.iterations_ms: list[float] = []
        self._client = ActionClient(self, contract.type, contract.name)
        self._is_sent = False
        self._next_try = 0.0
        self._is_complete = False
        self.listen(shared.REAL_TIME_FACTOR, self._on_real_time_factor)

    @property
    def missing(self) -> list[str]:
        """Nodes of the cell that are not up."""
        return [peer for peer in self._peers if not self.count_publishers(f"/alive/{peer}")]

    def pursue(self) -> None:
        """Send the goal if it is not on its way; to be called again and again."""
        if self._is_sent or self.missing:
            return
        if not self._is_complete:
            self._is_complete, self._next_try = True, time.monotonic() + SETTLE
        if time.monotonic() >= self._next_try and self._client.server_is_ready():
            self._is_sent = True
            future = self._client.send_goal_async(self.goal, feedback_callback=self._on_feedback)
            future.add_done_callback(self._on_answer)

    def _on_answer(self, future: Future) -> None:
        handle = future.result()
        self.is_accepted = self._is_sent = handle.accepted
        self._next_try = time.monotonic() + RETRY
        if handle.accepted:
            handle.get_result_async().add_done_callback(self._on_result)

    def _on_feedback(self, message: Any) -> None:
        self.feedback = message.feedback
        if hasattr(message.feedback, "iteration_ms"):
            self.iterations_ms.append(message.feedback.iteration_ms)

    def _on_result(self, future: Future) -> None:
        self.result = future.result().result

    def _on_real_time_factor(self, message: Any) -> None:
        self.real_time_factor = message.data
        if self.is_accepted and self.result is None:
            self.factors.append(message.data)


def follow_goal(
    make: Callable[[], GoalClient],
    on_turn: Callable[[GoalClient], None],
    *,
    domain: int | None = None,
    linger: float = 0.0,
) -> Any:
    """Send a goal and wait for its result, leaving signals to the caller.

    Args:
        make: builds the node that sends it.
        on_turn: is called about ten times a second of wall clock; what it raises ends the wait.
        domain: ROS domain; the environment's if None.
        linger: wall clock to stay after the result, so that the end is recorded [s].
    """
    rclpy.init(domain_id=domain, signal_handler_options=SignalHandlerOptions.NO)
    executor, node = SingleThreadedExecutor(), None
    try:
        node = make()
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


def _turn(executor: SingleThreadedExecutor, node: GoalClient, on_turn: Callable[[GoalClient], None]) -> None:
    end = time.monotonic() + 0.1
    while (rest := end - time.monotonic()) > 0.0:
        executor.spin_once(timeout_sec=rest)
    node.pursue()
    on_turn(node)
