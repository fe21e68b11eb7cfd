"""Tells at once that a node of this machine has ended, however it ended.

A node listens on a local socket, and its watchers connect to it. When the process ends, even by `kill -9`,
the system closes the socket and every watcher's blocking read returns. The middleware's liveliness also sees
nodes of other machines, but has to wait for a lease that must be longer than the time for which a busy
processor may keep a healthy node waiting.

Nobody else can be in the way: connecting never waits, each side asks the system whose process is at the other
end and talks to those of its own user only, and what watchers left behind is cleared away.
"""

from __future__ import annotations

import os
import select
import socket
import struct
import threading
from contextlib import suppress
from pathlib import Path

from pack_core.errors import ConfigError

SOCKETS = Path("/proc/net/unix")
"""Linux' list of local sockets. A line ends with the address, `@` standing for its leading zero byte."""
BACKLOG = 64
"""Watchers that the system queues until they are accepted."""
MOST_WATCHERS = 256
"""Connections that a node keeps; more wait in the queue. Once it is full, watchers rely on the lease."""
CREDENTIALS = struct.Struct("3i")
"""What Linux tells of the process at the other end (SO_PEERCRED, unix(7)): its id, user and group."""
ROOT = 0
"""User id of root, who may do anyhow what every user may."""
CONNECT_TIMEOUT = 0.1
"""Longest time for which a watcher waits for the answer of a socket that nobody serves [s]."""


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
        self._watchers: dict[int, socket.socket] = {}
        # Closing a socket does not wake who waits for it; this pair does.
        self._end, self._wake = socket.socketpair()
        self._thread = threading.Thread(target=self._serve, name="watch socket", daemon=True)
        self.is_first = False
        with suppress(OSError):
            self._socket.bind(_address(domain, name))
            self._socket.listen(BACKLOG)
            self._socket.setblocking(False)
            self.is_first = True
            self._thread.start()

    def close(self) -> None:
        """Let the watchers know that the node ends."""
        self._wake.close()
        if self._thread.ident is not None:
            self._thread.join()
        for part in (self._socket, self._end, *self._watchers.values()):
            part.close()

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
                    self._watchers.pop(number).close()
                    events.register(self._socket, select.POLLIN)

    def _accept(self, events: select.poll) -> None:
        with suppress(OSError):
            watcher, _ = self._socket.accept()
            if not _is_of_this_user(watcher):
                watcher.close()
                return
            self._watchers[watcher.fileno()] = watcher
            events.register(watcher, select.POLLIN)
            if len(self._watchers) >= MOST_WATCHERS:
                events.unregister(self._socket)  # closing one more would tell its watcher that the node ended


class WatchConnection:
    """The watcher's side: a connection to a node of this machine.

    Args:
        domain: ROS domain id.
        name: of the watched node.

    Attributes:
        is_open: whether the node was there and has not been seen to end since.
    """

    def __init__(self, domain: int, name: str) -> None:
        self._socket = socket.socket(socket.AF_UNIX)
        self.is_open = False
        with suppress(OSError):
            # Without the limit it would wait for ever where the queue of the other side is full.
            self._socket.settimeout(CONNECT_TIMEOUT)
            self._socket.connect(_address(domain, name))
            self._socket.settimeout(None)
            self.is_open = _is_of_this_user(self._socket)

    def wait_for_end(self) -> None:
        """Return when the node has ended, or after `close`; at once if there is no connection."""
        with suppress(OSError):
            if self.is_open:
                self._socket.recv(1)  # nothing is ever sent: it returns when the other end is gone
        self.is_open = False

    def close(self) -> None:
        """Watch no longer; any thread may call it, and more than once."""
        with suppress(OSError):
            self._socket.shutdown(socket.SHUT_RDWR)  # wakes who waits, which `close` alone does not
        self._socket.close()


def nodes_on_this_machine() -> dict[int, set[str]]:
    """Names of the nodes that run on this machine, by ROS domain; nodes of other machines are not seen."""
    found: dict[int, set[str]] = {}
    for line in SOCKETS.read_text().splitlines():
        folder, _, rest = line.rpartition(" ")[2].partition("/")
        domain, _, name = rest.partition("/")
        if folder == "@packcell" and domain.isdecimal() and name:
            found.setdefault(int(domain), set()).add(name)
    return found


def check_name_is_free(domain: int, name: str) -> None:
    """Refuse a second node of a name; of two that publish and command the same, nobody knew which is which.

    Raises:
        ConfigError: a node of this name runs on this machine in the ROS domain.
    """
    if name in nodes_on_this_machine().get(domain, ()):
        raise ConfigError(
            f"a node '{name}' runs already in ROS domain {domain}; end it, or use another domain "
            "(ROS_DOMAIN_ID); `pack status` says what runs"
        )


def _is_of_this_user(connection: socket.socket) -> bool:
    """Whether the process at the other end runs as our user, or as root."""
    packed = connection.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, CREDENTIALS.size)
    _, user, _ = CREDENTIALS.unpack(packed)
    return user in (os.geteuid(), ROOT)


def _address(domain: int, name: str) -> str:
    # The leading zero byte makes it an abstract address: no file that a killed process would leave behind.
    return f"\0packcell/{domain}/{name}"
