"""Watch over another node: does it still say that it is alive, and does its process still exist?"""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any

from rclpy.clock import Clock, ClockType
from rclpy.duration import Duration
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.node import Node
from rclpy.qos import LivelinessPolicy, QoSProfile
from std_msgs.msg import Empty

from pack_core.ros.lifeline import Grasp

LEASE = Duration(seconds=0.5)
"""A node is dead when it has not been heard of for this long, in wall clock; one of this machine whose
process ends is known to be dead at once."""
REACH_PERIOD = 0.1
"""How often a peer that is not held is reached for [s of wall clock]."""
ALIVE_QOS = QoSProfile(depth=1, liveliness=LivelinessPolicy.MANUAL_BY_TOPIC, liveliness_lease_duration=LEASE)


def alive_topic(name: str) -> str:
    """Where a node asserts that it is alive."""
    return f"/alive/{name}"


class PeerWatch:
    """Tells when a peer comes and when it ends.

    Args:
        node: who watches.
        peer: name of the node that is watched.
        on_change: `on_change(peer, is_alive)`, from the executor or from a thread; never twice the same.

    Attributes:
        peer: who is watched.
    """

    def __init__(self, node: Node, peer: str, on_change: Callable[[str, bool], None]) -> None:
        self.peer = peer
        self._node, self._on_change = node, on_change
        self._is_alive: bool | None = None
        self._lock = threading.Lock()
        self._grasp: Grasp | None = None
        node.create_timer(REACH_PERIOD, self._reach, clock=Clock(clock_type=ClockType.STEADY_TIME))
        node.create_subscription(
            Empty, alive_topic(peer), lambda _: None, ALIVE_QOS,
            event_callbacks=SubscriptionEventCallbacks(liveliness=self._on_liveliness),
        )  # fmt: skip

    @property
    def is_alive(self) -> bool:
        """Whether the peer has been heard of, and not fallen silent since."""
        return self._is_alive is True

    def end(self) -> None:
        """Watch no longer."""
        if self._grasp is not None:
            self._grasp.release()

    def _on_liveliness(self, event: Any) -> None:
        self._change(event.alive_count > 0)

    def _reach(self) -> None:
        """Take hold of the peer's lifeline as soon as there is one: it came, or came back."""
        if self._grasp is not None and self._grasp.is_held:
            return
        grasp = Grasp(self._node.context.get_domain_id(), self.peer, lambda: self._change(False))
        if grasp.is_held:
            self._grasp = grasp
            self._change(True)
        else:
            grasp.release()

    def _change(self, is_alive: bool) -> None:
        with self._lock:
            if self._is_alive is is_alive or not self._node.context.ok():
                return
            self._is_alive = is_alive
            try:
                self._on_change(self.peer, is_alive)
            except Exception:
                if self._node.context.ok():
                    raise  # otherwise the watching node has ended in between
