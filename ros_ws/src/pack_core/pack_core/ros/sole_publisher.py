"""Notices at once when a topic that belongs to one node has another publisher besides, and names them all.

A message does not tell who sent it; but the middleware tells who publishes, before the first message of a
publisher can come. So a second one is noticed in time, while its messages cannot be told from those of the
first: whoever must not follow both follows neither.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from rclpy.node import Node
from rclpy.topic_endpoint_info import TopicEndpointInfo

GUID_BYTES = 16
"""Length of a publisher's identity (GUID, DDS); what rclpy hands out is longer, padded with zeros."""


class SolePublisher:
    """Watches who publishes a topic: whenever `check` is called, as for every match of a `Stream`.

    Args:
        node: that listens to the topic.
        topic: its name.
        on_change: is told, in words, who publishes when that is more than one, and "" when it is one again;
            called by whoever checks.

    Attributes:
        trouble: who publishes, in words, while that is more than one; else empty.
    """

    def __init__(self, node: Node, topic: str, on_change: Callable[[str], None]) -> None:
        self._node, self._topic, self._on_change = node, topic, on_change
        self._left_over: set[bytes] = set()
        self._tracked: set[str] = set()
        self.trouble = ""

    def track(self, name: str) -> None:
        """Count every publisher of the nodes of this name, since `forget` will tell of their ends.

        The publishers of other names count as one: an older one may be that of a process that was killed,
        which the middleware lists for up to 20 s more.
        """
        self._tracked.add(name)

    def forget(self, name: str) -> None:
        """The process of a node has ended: its publishers, which are still listed, count no more."""
        self._left_over |= {_identity(info) for info in self._publishers() if info.node_name == name}

    def check(self) -> None:
        """Compare with who publishes now."""
        if not self.trouble and self._node.count_publishers(self._topic) <= 1:
            return  # counting takes a fiftieth of asking who they are
        present = [info for info in self._publishers() if _identity(info) not in self._left_over]
        listed = sorted(f"'{info.node_name}' ({_identity(info).hex()})" for info in present)
        senders = {_identity(info) if info.node_name in self._tracked else info.node_name for info in present}
        trouble = f"{self._topic} is published by {' and '.join(listed)}" if len(senders) > 1 else ""
        if trouble != self.trouble:
            self.trouble = trouble
            self._on_change(trouble)

    def _publishers(self) -> list[TopicEndpointInfo]:
        found: Any = self._node.get_publishers_info_by_topic(self._topic)
        return list(found)


def _identity(info: TopicEndpointInfo) -> bytes:
    return bytes(info.endpoint_gid)[:GUID_BYTES]
