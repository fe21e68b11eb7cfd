"""Base of every node: sign of life, health, and watch over its peers."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterable
from contextlib import suppress
from functools import partial
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray
from rclpy.exceptions import InvalidHandle

from pack_core.errors import ConfigError
from pack_core.ros.clocked_node import ClockedNode
from pack_core.ros.contracts import shared
from pack_core.ros.local_nodes import check_name_is_free
from pack_core.ros.node_status import StatusTeller
from pack_core.ros.params import unknown_parameters
from pack_core.ros.peer_watch import PeerWatch
from pack_core.ros.sign_of_life import SignOfLife
from pack_core.ros.silence_log import SilenceLog
from pack_core.ros.watch_socket import WatchSocket

ASSERTION_PERIOD = 0.05
"""How often a node says that it is alive [s of wall clock]: ten times within the lease, as some come late."""
READINESS_PERIOD = 0.1
"""How often a node that has just started looks whether it is ready [s of wall clock]."""


class CellNode(ClockedNode):
    """A node of a cell, or one that talks to a cell. Its health is published on /diagnostics once a second.

    Attributes:
        may_be_repeated: whether a domain may have several nodes of its name.
    """

    may_be_repeated = False

    def __init__(self, name: str, **kwargs: Any) -> None:
        super().__init__(name, **kwargs)
        if not self.may_be_repeated:
            check_name_is_free(self.context.get_domain_id(), self.get_name())
        self._diagnostics = self.advertise(shared.DIAGNOSTICS)
        self._status_teller = StatusTeller(self)
        self._silences = SilenceLog(self.get_logger())
        self.create_timer(1.0, self._look_around, clock=self.wall)
        self._ended = threading.Event()
        self._watch_socket: WatchSocket | None = None
        self._watches: list[PeerWatch] = []
        self._heart: threading.Thread | None = None
        # Not guarded: a node that was configured wrongly ends here.
        self._birth = self.create_bare_timer(0.001, self._come_alive, clock=self.wall)
        self._readiness = self.create_timer(READINESS_PERIOD, self._look_whether_ready, clock=self.wall)

    @property
    def is_up(self) -> bool:
        """Whether the node has said that it is alive: its configuration was in order."""
        return self._heart is not None

    @property
    def waits_for(self) -> str:
        """What the node needs of others before it can do its work, in words; empty: it is ready."""
        return ""

    @property
    def is_busy(self) -> bool:
        """Whether the node pursues a goal."""
        return False

    def tell_status(self) -> None:
        """Say on /node_status where the node stands, if that has changed; to be called from the executor."""
        if self.is_up:  # before that its configuration may still turn out to be wrong
            self._status_teller.tell("" if self.is_busy else self.waits_for, is_busy=self.is_busy)

    def destroy_node(self) -> None:
        """Stop saying that the node is alive, then end."""
        self._ended.set()
        if self._heart is not None:
            self._heart.join()
        for watch in self._watches:
            watch.end()
        super().destroy_node()
        if self._watch_socket is not None:
            self._watch_socket.close()

    def _come_alive(self) -> None:
        """Say for the first time that the node is alive, in the executor's first turn.

        Not in the constructor: what a subclass builds there may take longer than the lease, and the node
        would be taken for dead before it has begun.
        """
        self._birth.cancel()
        if said := unknown_parameters(self):
            raise ConfigError(f"node '{self.get_name()}' has no parameter {', and none '.join(said)}")
        self._watch_socket = WatchSocket(self.context.get_domain_id(), self.get_name())
        sign = SignOfLife(self, self.get_name())
        self._heart = threading.Thread(target=self._beat, args=(sign,), name="alive", daemon=True)
        self._heart.start()
        for watch in self._watches:
            watch.begin()

    def _look_whether_ready(self) -> None:
        self.tell_status()
        if self._status_teller.is_ready:
            self._readiness.cancel()

    def _look_around(self) -> None:
        self.tell_status()
        self._silences.write(self._watches, time.monotonic())
        self.report()

    def _beat(self, sign: SignOfLife) -> None:
        # A thread, because a timer would wait for callbacks that compute for longer than the lease.
        with suppress(InvalidHandle, RuntimeError):  # the context may end first
            while not self._ended.wait(ASSERTION_PERIOD) and self.context.ok():
                sign.give()

    def watch(self, peers: Iterable[str], on_change: Callable[[str, bool], None] | None = None) -> None:
        """Report peers that die; `on_change(peer, is_alive)` is called when one dies or comes (back)."""
        for peer in peers:
            watch = PeerWatch(self, peer, partial(self._on_peer_change, on_change), self._on_peer_end)
            self.expect_clock_of(peer)
            self._watches.append(watch)
            if self.is_up:
                watch.begin()

    def hears(self, peer: str) -> bool:
        """Whether a watched peer has been heard of, and not fallen silent since."""
        return any(watch.is_alive for watch in self._watches if watch.peer == peer)

    def on_peer_end(self, peer: str) -> None:
        """A process of a watched peer has ended, and what it knew is lost; called from another thread."""

    def _on_peer_end(self, peer: str) -> None:
        try:
            self.forget_clock_of(peer)
            self.on_peer_end(peer)
        except Exception as error:
            self.fail(f"watch over {peer}", error)

    def _on_peer_change(
        self, on_change: Callable[[str, bool], None] | None, peer: str, is_alive: bool
    ) -> None:
        if on_change:
            try:
                on_change(peer, is_alive)
            except Exception as error:  # also in the thread that watches, which must go on
                self.fail(f"watch over {peer}", error)
        if is_alive:
            self.health.faults.pop(peer, None)
        else:
            self.health.faults[peer] = f"node '{peer}' is silent: restart it (pack run, or pack up)"
            self._silences.note(peer, time.monotonic())
            self.report()

    def report(self) -> None:
        """Publish this node's health on /diagnostics."""
        message = DiagnosticArray(status=[self.health.status()])
        message.header.stamp = self.get_clock().now().to_msg()
        self._diagnostics.publish(message)
