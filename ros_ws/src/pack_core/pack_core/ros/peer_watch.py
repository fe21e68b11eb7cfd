"""Watch over another node, in two ways.

Every node gives signs of life; the middleware reports when it has not done so for the length of a lease,
also from another machine and also when the process hangs. A connection to the process (`watch_connection`)
tells the end of one on this machine at once.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import Any

from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.node import Node
from std_msgs.msg import Empty

from pack_core.ros.sign_of_life import ALIVE_QOS, alive_topic
from pack_core.ros.watch_connection import WatchConnection

CONNECT_PERIOD = 0.1
"""How often a connection to a peer without one is tried [s of wall clock]."""


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
            self._connection = connection = WatchConnection(domain, self.peer)
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
