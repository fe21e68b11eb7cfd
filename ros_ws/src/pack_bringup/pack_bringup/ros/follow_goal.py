"""Sends a goal to a running cell and follows it to its end."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.signals import SignalHandlerOptions

from pack_bringup.ros.goal_client import GoalClient
from pack_core.ros.run import confirm_network, start_ros


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
    start_ros(domain_id=domain, signal_handler_options=SignalHandlerOptions.NO)
    executor, node = SingleThreadedExecutor(), None
    try:
        node = make()
        confirm_network()
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
