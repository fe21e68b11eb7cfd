"""The local sockets by which the nodes of this machine know of each other."""

from __future__ import annotations

import os
import socket
import struct
from pathlib import Path

from pack_core.errors import ConfigError

SOCKETS = Path("/proc/net/unix")
"""Linux' list of local sockets. A line ends with the address, `@` standing for its leading zero byte."""
CREDENTIALS = struct.Struct("3i")
"""What Linux tells of the process at the other end (SO_PEERCRED, unix(7)): its id, user and group."""
NUMBER = struct.Struct("H")
"""What a node sends to a watcher, once: the number of its mutex, and with it the memory that it is in."""
READINGS = 3
"""Of the list, one after the other: a single one leaves out a socket now and then."""
ROOT = 0
"""User id of root, who may do anyhow what every user may."""


def nodes_on_this_machine() -> dict[int, set[str]]:
    """Names of the nodes that run on this machine, by ROS domain; nodes of other machines are not seen."""
    found: dict[int, set[str]] = {}
    # Linux hands the list out page by page and finds its place again by counting: while sockets of others are
    # closed, one reading in some thousands skips a socket that was there all the time.
    for line in [line for _ in range(READINGS) for line in SOCKETS.read_text().splitlines()]:
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


def is_of_this_user(connection: socket.socket) -> bool:
    """Whether the process at the other end runs as our user, or as root."""
    packed = connection.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, CREDENTIALS.size)
    _, user, _ = CREDENTIALS.unpack(packed)
    return user in (os.geteuid(), ROOT)


def address_of(domain: int, name: str) -> str:
    """Of the socket of a node in a ROS domain."""
    # The leading zero byte makes it an abstract address: no file that a killed process would leave behind.
    return f"\0packcell/{domain}/{name}"
