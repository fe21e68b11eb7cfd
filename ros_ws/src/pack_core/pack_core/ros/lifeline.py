"""Tells at once that a node of this machine has ended, however it ended.

A node listens on a socket that it never serves, and its watchers connect to it. The system closes the
socket together with the process, and they wake. The middleware's liveliness, which also sees nodes of
other machines, has to wait for a lease that is longer than a busy processor keeps a node waiting.
"""

from __future__ import annotations

import socket
import threading
from collections.abc import Callable
from contextlib import suppress

BACKLOG = 64


class Lifeline:
    """What watchers hold on to; it is cut when the node or its process ends."""

    def __init__(self, domain: int, name: str) -> None:
        self._socket = socket.socket(socket.AF_UNIX)
        with suppress(OSError):  # a second node of this name has none and is watched by its lease
            self._socket.bind(_address(domain, name))
            self._socket.listen(BACKLOG)

    def cut(self) -> None:
        """Let the watchers know that this is the end."""
        self._socket.close()


class Grasp:
    """Holds on to a node's lifeline, if it is on this machine.

    Args:
        domain: ROS domain id.
        name: of the node.
        on_cut: is called once, from a thread of its own, when the node has ended.

    Attributes:
        is_held: whether there was a lifeline and it has not been cut.
    """

    def __init__(self, domain: int, name: str, on_cut: Callable[[], None]) -> None:
        self._socket = socket.socket(socket.AF_UNIX)
        self._on_cut = on_cut
        self._is_released = False
        self.is_held = False
        with suppress(OSError):
            self._socket.connect(_address(domain, name))
            self.is_held = True
            threading.Thread(target=self._wait, name=f"lifeline of {name}", daemon=True).start()

    def release(self) -> None:
        """Hear no more of it."""
        self._is_released = True
        with suppress(OSError):
            self._socket.shutdown(socket.SHUT_RDWR)
        self._socket.close()

    def _wait(self) -> None:
        with suppress(OSError):
            self._socket.recv(1)
        self.is_held = False
        if not self._is_released:
            self._on_cut()


def _address(domain: int, name: str) -> str:
    return f"\0packcell/{domain}/{name}"
