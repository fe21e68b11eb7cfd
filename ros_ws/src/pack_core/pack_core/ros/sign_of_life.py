"""A node's sign of life, which the nodes that watch it hear (`PeerWatch`)."""

from __future__ import annotations

import time

from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.qos import LivelinessPolicy, QoSProfile
from std_msgs.msg import Empty

LEASE = Duration(seconds=0.5)
"""A node counts as dead when it has not been heard of for this long, in wall clock."""
ALIVE_QOS = QoSProfile(depth=1, liveliness=LivelinessPolicy.MANUAL_BY_TOPIC, liveliness_lease_duration=LEASE)
MESSAGE_PERIOD = 1.0
"""How often the sign is a message as well [s of wall clock]."""


def alive_topic(name: str) -> str:
    """Where a node asserts that it is alive."""
    return f"/alive/{name}"


class SignOfLife:
    """Asserts the liveliness of a node (DDS liveliness, MANUAL_BY_TOPIC).

    Once a second it is a message, too: the middleware does not always report that a publisher which was
    silent is heard again.

    Args:
        node: that has the publisher.
        name: of the node that is alive.
    """

    def __init__(self, node: Node, name: str) -> None:
        self._publisher = node.create_publisher(Empty, alive_topic(name), ALIVE_QOS)
        self._sent = -float("inf")

    def give(self) -> None:
        """Say that the node is alive; to be called several times within the lease."""
        if (now := time.monotonic()) - self._sent < MESSAGE_PERIOD:
            self._publisher.assert_liveliness()
        else:
            self._sent = now
            self._publisher.publish(Empty())
