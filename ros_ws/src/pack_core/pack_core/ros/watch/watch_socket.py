"""Lets others know at once that this node has ended, however it ended; see `watch_connection`."""

from __future__ import annotations

import select
import socket
import threading
from contextlib import suppress
from dataclasses import dataclass

from pack_core.ros.watch.death_notice import SYS_FUTEX, HeldMutexes
from pack_core.ros.watch.local_nodes import NUMBER, address_of, is_of_this_user

BACKLOG = 64
"""Watchers that the system queues until they are accepted."""
MOST_WATCHERS = 256
"""Connections that a node keeps; more wait in the queue. Once it is full, watchers rely on the lease."""


class WatchSocket:
    """The watched node's side: watchers connect to it, and learn of its end when it closes.

    Args:
        domain: ROS domain id.
        name: of the node.

    Attributes:
        is_first: whether no other process had the node's name in the domain; a second one has no address
            and is watched by its lease.
    """

    def __init__(self, domain: int, name: str) -> None:
        self._socket = socket.socket(socket.AF_UNIX)
        self._watchers: dict[int, _Watcher] = {}
        self._mutexes: HeldMutexes | None = None
        # Closing a socket does not wake who waits for it; this pair does.
        self._end, self._wake = socket.socketpair()
        self._thread = threading.Thread(target=self._serve, name="watch socket", daemon=True)
        self.is_first = False
        with suppress(OSError):
            self._socket.bind(address_of(domain, name))
            self._socket.listen(BACKLOG)
            self._socket.setblocking(False)
            self.is_first = True
            self._mutexes = HeldMutexes(MOST_WATCHERS) if SYS_FUTEX else None
            self._thread.start()

    def close(self) -> None:
        """Let the watchers know that the node ends."""
        self._wake.close()
        if self._thread.ident is not None:
            self._thread.join()  # with its thread the mutexes end, and the watchers are woken
        for part in (self._socket, self._end, *(watcher.socket for watcher in self._watchers.values())):
            part.close()
        if self._mutexes is not None:
            self._mutexes.close()

    def _serve(self) -> None:
        """Accept watchers and clear away those that went, until the node ends."""
        events = select.poll()
        events.register(self._socket, select.POLLIN)
        events.register(self._end, select.POLLIN)
        while True:
            for number, _ in events.poll():
                if number == self._end.fileno():
                    return
                if number == self._socket.fileno():
                    self._accept(events)
                else:  # a watcher sends nothing: it has gone
                    events.unregister(number)
                    self._forget(self._watchers.pop(number))
                    events.register(self._socket, select.POLLIN)

    def _accept(self, events: select.poll) -> None:
        with suppress(OSError):
            connection, _ = self._socket.accept()
            if not is_of_this_user(connection):
                connection.close()
                return
            watcher = _Watcher(connection, self._mutexes.hold() if self._mutexes else 0)
            self._watchers[connection.fileno()] = watcher
            events.register(connection, select.POLLIN)
            if len(self._watchers) >= MOST_WATCHERS:
                events.unregister(self._socket)  # closing one more would tell its watcher that the node ended
            descriptors = [self._mutexes.memory_fd] if self._mutexes else []
            socket.send_fds(connection, [NUMBER.pack(watcher.mutex)], descriptors)

    def _forget(self, watcher: _Watcher) -> None:
        if self._mutexes is not None:
            self._mutexes.release(watcher.mutex)
        watcher.socket.close()


@dataclass(frozen=True)
class _Watcher:
    """Who watches: its connection, and the number of the mutex that it waits for."""

    socket: socket.socket
    mutex: int
