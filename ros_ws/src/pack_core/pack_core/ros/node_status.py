"""How far a node has come since its start, for whoever brings a cell up or wants to know what runs."""

from __future__ import annotations

import time

from pack_interfaces.msg import NodeStatus
from rclpy.node import Node
from rclpy.qos import QoSProfile

from pack_core.ros.contracts import shared

LISTENING = QoSProfile(
    depth=100, reliability=shared.NODE_STATUS.qos.reliability, durability=shared.NODE_STATUS.qos.durability
)
"""For a listener: every node keeps its last status, and all of them come at once."""


class NodeStatusPublisher:
    """Says on /node_status where a node stands, whenever that has changed.

    Args:
        node: the node, which is starting.
    """

    def __init__(self, node: Node) -> None:
        contract = shared.NODE_STATUS
        self._publisher = node.create_publisher(contract.type, contract.name, contract.qos)
        now = time.time()
        self._status = NodeStatus(name=node.get_name(), state=NodeStatus.STARTING, started=now, since=now)
        self._publisher.publish(self._status)

    @property
    def is_ready(self) -> bool:
        """Whether the node has said that it can do its work, or is at it."""
        return self._status.state in (NodeStatus.READY, NodeStatus.BUSY)

    def publish(self, waits_for: str, *, is_busy: bool) -> None:
        """Publish where the node stands, if it is news.

        Args:
            waits_for: what it needs before it can do its work, in words; empty: nothing.
            is_busy: whether it pursues a goal.
        """
        if is_busy:
            state, waits_for = NodeStatus.BUSY, ""
        else:
            state = NodeStatus.WAITING if waits_for else NodeStatus.READY
        if (state, waits_for) == (self._status.state, self._status.waits_for):
            return
        last = self._status
        since = last.since if state == last.state else time.time()
        self._status = NodeStatus(
            name=last.name, state=state, waits_for=waits_for, started=last.started, since=since
        )
        self._publisher.publish(self._status)
