"""Namespaces, in which two cells of one ROS domain have the same names."""

from __future__ import annotations

import re

from pack_core.errors import ConfigError

ROOT = "/"
ALLOWED = re.compile(r"(/[A-Za-z_][A-Za-z0-9_]*)+")
"""What rcl allows (design.ros2.org, topic and service names), without a slash at the end."""
OUTSIDE_CELLS = ("/parameter_events",)
"""Topics of the middleware that every node of a domain shares, whatever its namespace: they name the node."""


def below(namespace: str, name: str) -> str:
    """An absolute name within a namespace; a relative one, which rcl completes, is returned as it is."""
    return name if namespace == ROOT or not name.startswith("/") else namespace + name


def in_cell(namespace: str, name: str) -> str:
    """The name that an endpoint of the wiring table has in a cell in a namespace."""
    return name if name in OUTSIDE_CELLS else below(namespace, name)


def lifeline(namespace: str, node: str) -> str:
    """By which name a node of a cell in a namespace is known on this machine."""
    return below(namespace, f"/{node}").removeprefix("/")


def checked_namespace(given: str) -> str:
    """A namespace as rcl writes it, from `left`, `/left` or `hall/left`; `/` where nothing is given.

    Raises:
        ConfigError: it is none.
    """
    namespace = "/" + given.strip("/")
    if namespace != ROOT and not ALLOWED.fullmatch(namespace):
        raise ConfigError(
            f"namespace '{given}'; allowed: letters, digits and _, not beginning with a digit, with / "
            "between parts, e.g. left"
        )
    return namespace
