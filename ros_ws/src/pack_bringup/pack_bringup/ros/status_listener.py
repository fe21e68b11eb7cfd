"""Hears where the nodes of a ROS domain stand, from outside of any cell."""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from types import TracebackType
from typing import Self

import rclpy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from pack_interfaces.msg import NodeStatus
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.signals import SignalHandlerOptions

from pack_bringup.ros.deferred_signals import deferred_signals
from pack_core.namespace import ROOT, below
from pack_core.ros.contracts import shared
from pack_core.ros.node_status import LISTENING
from pack_core.ros.run import confirm_network, start_ros

STATE_WORDS = {
    NodeStatus.STARTING: "starting",
    NodeStatus.WAITING: "waiting",
    NodeStatus.READY: "ready",
    NodeStatus.BUSY: "pursues a goal",
}


class StatusListener:
    """A node for the time of a `with` block; nothing is heard but in `spin_until`.

    Args:
        domain: ROS domain id.
        namespace: of the cell, as rcl writes it.

    Attributes:
        node: that listens, within the block.
        statuses: the newest status of each node, by name.
        health: the newest diagnostics of each node, by name.
    """

    name = "status"
    """How the node's name begins."""
    turn = 0.1
    """Longest time until the condition is looked at again [s of wall clock]."""

    def __init__(self, domain: int, namespace: str = ROOT) -> None:
        self._domain, self._namespace = domain, namespace
        self.statuses: dict[str, NodeStatus] = {}
        self.health: dict[str, DiagnosticStatus] = {}

    def __enter__(self) -> Self:
        self._context = Context()
        signals = SignalHandlerOptions.NO  # they are the caller's
        start_ros(context=self._context, domain_id=self._domain, signal_handler_options=signals)
        # No CellNode: it only listens, and two of them may listen at a time.
        self.node = rclpy.create_node(f"{self.name}_{os.getpid()}", context=self._context)
        confirm_network()
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self.node)
        statuses, diagnostics = (
            below(self._namespace, contract.name) for contract in (shared.NODE_STATUS, shared.DIAGNOSTICS)
        )
        self.node.create_subscription(NodeStatus, statuses, self._on_status, LISTENING)
        self.node.create_subscription(DiagnosticArray, diagnostics, self._on_health, shared.DIAGNOSTICS.qos)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._executor.shutdown()
        self.node.destroy_node()
        self._context.try_shutdown()

    def spin_until(self, condition: Callable[[], bool], timeout: float) -> bool:
        """Listen until a condition holds; False if `timeout` [s of wall clock] came first."""
        deadline = time.monotonic() + timeout
        while not condition():
            rest = deadline - time.monotonic()
            if rest <= 0.0:
                return False
            with deferred_signals():
                self._executor.spin_once(timeout_sec=min(rest, self.turn))
            self.take()
        return True

    def take(self) -> None:
        """Take what has come besides what callbacks take; called after each turn."""

    def unready(self, names: list[str]) -> dict[str, str]:
        """Those of some nodes that are not ready, each with what it waits for, in words."""
        found = {}
        for name in names:
            status = self.statuses.get(name)
            if status is None or status.state == NodeStatus.STARTING:
                found[name] = "starting"
            elif status.state == NodeStatus.WAITING:
                found[name] = status.waits_for
        return found

    def _on_status(self, status: NodeStatus) -> None:
        self.statuses[status.name] = status

    def _on_health(self, message: DiagnosticArray) -> None:
        self.health.update({status.name: status for status in message.status})
