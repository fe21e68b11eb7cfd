"""Tells at once that a node of this machine has ended, however it ended.

A node listens on a local socket, its watchers connect to it, and each is handed a mutex that the node holds
(`death_notice`). When the process ends, even by `kill -9`, the system marks the mutex and wakes the watcher.
The middleware's liveliness also sees nodes of other machines, but has to wait for a lease that must be longer
than the time for which a busy processor may keep a healthy node waiting.

Nobody else can be in the way: connecting never waits, each side asks the system whose process is at the other
end and talks to those of its own user only, and what watchers left behind is cleared away.
"""

from __future__ import annotations

import socket
from contextlib import suppress

from pack_core.ros.watch.death_notice import DeathNotice
from pack_core.ros.watch.local_nodes import NUMBER, address_of, is_of_this_user

CONNECT_TIMEOUT = 0.1
"""Longest time for which a watcher waits for the answer of a socket that nobody serves [s]."""


class WatchConnection:
    """The watcher's side: a connection to a node of this machine.

    Args:
        domain: ROS domain id.
        name: of the watched node.

    Attributes:
        is_open: whether the node's socket was there and has not been seen to end since.
        is_answered: whether the node has let us in since, which one that ends or stands does not.
    """

    def __init__(self, domain: int, name: str) -> None:
        self._socket = socket.socket(socket.AF_UNIX)
        self._notice: DeathNotice | None = None
        self.is_open = self.is_answered = self._is_closed = False
        with suppress(OSError):
            # Without the limit it would wait for ever where the queue of the other side is full.
            self._socket.settimeout(CONNECT_TIMEOUT)
            self._socket.connect(address_of(domain, name))
            self._socket.settimeout(None)
            self.is_open = is_of_this_user(self._socket)

    def wait_for_answer(self) -> bool:
        """Wait until the node lets us in (True), or has ended, or after `close` (False)."""
        with suppress(OSError):
            if self.is_open and not self.is_answered:
                answer = socket.recv_fds(self._socket, NUMBER.size, 1, socket.MSG_CMSG_CLOEXEC)
                data, descriptors = answer[:2]
                if descriptors:
                    self._notice = DeathNotice(descriptors[0], *NUMBER.unpack(data))
                self.is_open = self.is_answered = bool(data)
        return self.is_answered

    def wait_for_end(self) -> None:
        """Return when the node has ended, or after `close`; at once if there is no connection."""
        if self.wait_for_answer() and not self._is_closed:
            if self._notice is not None:
                self._notice.wait()
            else:
                with suppress(OSError):
                    self._socket.recv(1)  # nothing more is sent: it returns when the other end is gone
        self.is_open = self.is_answered = False

    def close(self) -> None:
        """Watch no longer; any thread may call it, and more than once."""
        self._is_closed = True
        if self._notice is not None:
            self._notice.cancel()
        with suppress(OSError):
            self._socket.shutdown(socket.SHUT_RDWR)  # wakes who waits, which `close` alone does not
        self._socket.close()
