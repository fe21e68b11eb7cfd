"""Namespaces, in which two cells of one ROS domain have the same names."""

from __future__ import annotations

import re

from pack_core.errors import ConfigError

ROOT = "/"
ALLOWED = re.compile(r"(/[A-Za-z_][A-Za-z0-9_]*)+")
"""What rcl allows (design.ros2.org, topic and service names), without a slash at the end."""


def below(namespace: str, name: str) -> str:
    """An absolute name within a namespace; a relative one, which rcl completes, is returned as it is."""
    return name if namespace == ROOT or not name.startswith("/") else namespace + name


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
