"""Finds a ROS domain that nobody on this machine uses, so that two runs do not hear each other."""

from __future__ import annotations

import os
import socket
from collections.abc import Mapping

from pack_core.errors import PackError
from pack_core.network import LAST_DOMAIN, domain_in

DOMAINS = LAST_DOMAIN - 1
"""Domain ids from 1 on that are tried."""


def choose_domain(environment: Mapping[str, str]) -> int:
    """The environment's ROS_DOMAIN_ID, else a free one.

    Raises:
        PackError: it is no domain, or every domain is in use.
    """
    if (given := domain_in(environment)) is not None:
        return given
    for k in range(DOMAINS):
        domain = 1 + (os.getpid() + k) % DOMAINS
        if is_free(domain):
            return domain
    raise PackError(f"all ROS domains from 1 to {DOMAINS} are in use on this machine; set ROS_DOMAIN_ID")


def is_free(domain: int) -> bool:
    """Whether no participant of this machine listens on the domain.

    The first one binds UDP port 7410 + 250 * domain (DDS Interoperability Wire Protocol, 9.6.2).
    """
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.bind(("", 7410 + 250 * domain))
        except OSError:
            return False
    return True
