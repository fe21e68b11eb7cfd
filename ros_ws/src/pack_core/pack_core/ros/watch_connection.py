"""Tells at once that a node of this machine has ended, however it ended.

A node listens on a local socket that it never serves, and its watchers connect to it. When the process ends,
even by `kill -9`, the system closes the socket and every watcher's blocking read returns. The middleware's
liveliness also sees nodes of other machines, but has to wait for a lease that must be longer than the time
for which a busy processor may keep a healthy node waiting.
"""

from __future__ import annotations

import socket
from contextlib import suppress
from pathlib import Path

SOCKETS = Path("/proc/net/unix")
"""Linux' list of local sockets. A line ends with the address, `@` standing for its leading zero byte."""
BACKLOG = 64
"""Watchers that the system queues: as nobody accepts them, one more could not connect."""


class WatchSocket:
    """The watched node's side: watchers connect to it, and learn of its end when it closes."""

    def __init__(self, domain: int, name: str) -> None:
        self._socket = socket.socket(socket.AF_UNIX)
        with suppress(OSError):  # a second node of this name has no address and is watched by its lease
            self._socket.bind(_address(domain, name))
            self._socket.listen(BACKLOG)

    def close(self) -> None:
        """Let the watchers know that the node ends."""
        self._socket.close()


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
            self._socket.connect(_address(domain, name))
            self.is_open = True

    def wait_for_end(self) -> None:
        """Return when the node has ended, or after `close`; at once if there is no connection."""
        with suppress(OSError):
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


def _address(domain: int, name: str) -> str:
    # The leading zero byte makes it an abstract address: no file that a killed process would leave behind.
    return f"\0packcell/{domain}/{name}"
