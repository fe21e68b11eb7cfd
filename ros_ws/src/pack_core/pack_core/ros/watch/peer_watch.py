"""Watch over other nodes, in two ways, and what is said of those that are silent.

Every node gives signs of life; the middleware reports when it has not done so for the length of a lease,
also from another machine and also when the process hangs. A connection to the process (`watch_connection`)
tells the end of one on this machine at once.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Sequence
from typing import Any

from rclpy.duration import Duration
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.node import Node
from rclpy.qos import LivelinessPolicy, QoSProfile
from std_msgs.msg import Empty

from pack_core.namespace import lifeline
from pack_core.ros.watch.watch_connection import WatchConnection

LEASE = Duration(seconds=0.5)
"""A node counts as dead when it has not been heard of for this long, in wall clock."""
ALIVE_QOS = QoSProfile(depth=1, liveliness=LivelinessPolicy.MANUAL_BY_TOPIC, liveliness_lease_duration=LEASE)
"""Of the sign of life, which the node itself gives: the middleware would go on while the node hangs."""
MESSAGE_PERIOD = 1.0
"""How often the sign is a message as well [s of wall clock]."""
CONNECT_PERIOD = 0.1
"""How often a connection to a peer without one is tried [s of wall clock]."""
LASTING = 3.0
"""Silence that is written to the log [s of wall clock]. It is acted upon and reported at once; but a busy
machine keeps nodes waiting while a cell starts, and nodes end one after the other when it ends."""


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


class PeerWatch:
    """Tells when a peer comes and when it ends.

    Args:
        node: who watches.
        peer: name of the node that is watched.
        on_change: `on_change(peer, is_alive)`, called from the executor or another thread, and only when
            `is_alive` has changed; not before `begin`.
        on_end: `on_end(peer)`, called from another thread, before `on_change`, whenever a process of the peer
            on this machine has ended.

    Attributes:
        peer: who is watched.
    """

    def __init__(
        self,
        node: Node,
        peer: str,
        on_change: Callable[[str, bool], None],
        on_end: Callable[[str], None] = lambda _: None,
    ) -> None:
        self.peer = peer
        self._node, self._on_change, self._on_end = node, on_change, on_end
        self._lifeline = lifeline(node.get_namespace(), peer)
        self._is_alive: bool | None = None
        self._silent_since_ns = 0
        self._lock = threading.Lock()
        self._connection: WatchConnection | None = None
        self._ended = threading.Event()
        # A thread of its own: a timer that looks every 0.1 s costs the executor 0.4 % of a core for a peer.
        self._thread = threading.Thread(target=self._keep_connected, name=f"watch over {peer}", daemon=True)
        node.create_subscription(
            Empty, alive_topic(peer), self._on_message, ALIVE_QOS,
            event_callbacks=SubscriptionEventCallbacks(liveliness=self._on_liveliness),
        )  # fmt: skip

    @property
    def is_alive(self) -> bool:
        """Whether the peer has been heard of, and not fallen silent since."""
        return self._is_alive is True

    @property
    def has_ended(self) -> bool:
        """Whether no process of the peer is known on this machine; one that lives but is silent may hang."""
        connection = self._connection
        return connection is None or not connection.is_answered

    def begin(self) -> None:
        """Watch from now on."""
        self._thread.start()

    def end(self) -> None:
        """Watch no longer."""
        self._ended.set()
        connection = self._connection
        if connection is not None:
            connection.close()
        if self._thread.ident is not None and self._thread is not threading.current_thread():
            self._thread.join()

    def _on_liveliness(self, event: Any) -> None:
        self._change(event.alive_count > 0)

    def _on_message(self, _: Empty, info: dict[str, Any]) -> None:
        """Hear a silent peer again where no event says so: after a silence Fast DDS leaves some out.

        What was sent before the silence was noticed may still be waiting to be read, and tells nothing.
        """
        if info["source_timestamp"] > self._silent_since_ns:
            self._change(True)

    def _keep_connected(self) -> None:
        """Connect to the peer as soon as it has come, or come back, and tell when it has ended."""
        domain = self._node.context.get_domain_id()
        while not self._ended.is_set():
            self._connection = connection = WatchConnection(domain, self._lifeline)
            # One that is being cleared away still has its socket, and answers no more.
            if connection.wait_for_answer() and not self._ended.is_set():
                self._change(True)
                connection.wait_for_end()
                if not self._ended.is_set():
                    self._on_end(self.peer)
                    self._change(False)
            connection.close()
            self._ended.wait(CONNECT_PERIOD)

    def _change(self, is_alive: bool) -> None:
        # Both ways of watching end here, each in its own thread: whoever notices first reports it.
        with self._lock:
            if self._is_alive is is_alive or not self._node.context.ok():
                return
            if self._is_alive is None and not is_alive:
                return  # it is being started: only who was heard can fall silent
            self._is_alive = is_alive
            if not is_alive:
                self._silent_since_ns = time.time_ns()
            try:
                self._on_change(self.peer, is_alive)
            except Exception:
                if self._node.context.ok():
                    raise  # otherwise the watching node has ended in between


class SilenceLog:
    """Writes a line for each silence that lasts; an error only where no process of the peer is left.

    Args:
        logger: of the node that watches.
    """

    def __init__(self, logger: Any) -> None:
        self._logger = logger
        self._since: dict[str, float] = {}

    def note(self, peer: str, now: float) -> None:
        """A peer has fallen silent at `now` [s]; any thread may say so."""
        self._since[peer] = now

    def write(self, watches: Sequence[PeerWatch], now: float) -> None:
        """Write about the silences that have lasted until `now` [s]; to be called now and then."""
        for peer, since in list(self._since.items()):
            watch = next(watch for watch in watches if watch.peer == peer)
            if watch.is_alive:
                self._since.pop(peer, None)
            elif now - since > LASTING:
                self._since.pop(peer, None)
                self._write(watch)

    def _write(self, watch: PeerWatch) -> None:
        if watch.has_ended:
            self._logger.error(f"node '{watch.peer}' has ended: restart it (pack run, or pack up)")
        else:
            self._logger.warning(
                f"node '{watch.peer}' lives but is silent: it hangs, or this machine is too busy"
            )


class SilentPeers:
    """The watched nodes that are silent now; true while there is one.

    Written by the threads that watch and read by the executor: each method reads a copy.
    """

    def __init__(self) -> None:
        self._since: dict[str, float] = {}

    def __bool__(self) -> bool:
        return bool(self._since)

    def __str__(self) -> str:
        return ", ".join(sorted(self._since.copy()))

    def note(self, peer: str, is_alive: bool, now: float) -> None:
        """A node has fallen silent, or was heard of again, at `now` [s]."""
        if is_alive:
            self._since.pop(peer, None)
        else:
            self._since.setdefault(peer, now)

    def lasting(self, duration: float, now: float) -> list[str]:
        """Names of the nodes that have been silent for longer than `duration` [s], sorted."""
        return sorted(peer for peer, since in self._since.copy().items() if now - since > duration)
