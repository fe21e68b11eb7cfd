"""Who can reach a node: what decides it, and the check of what was really bound (docs/operate/network.md).

The allow-list of the Fast DDS profile decides alone. Every other variable that ROS 2 or Fast DDS obey in this
matter is overruled or refused by name before the middleware starts: one of them inherited from somebody's
shell would open a cell without a word.
"""

from __future__ import annotations

import os
import socket
import struct
from collections.abc import Callable, Mapping, MutableMapping
from contextlib import suppress
from dataclasses import dataclass
from ipaddress import ip_address
from pathlib import Path
from xml.etree import ElementTree

from ament_index_python.resources import get_resources

from pack_core.addresses import LAST_DOMAIN, LOOPBACK
from pack_core.errors import ConfigError

PROFILE_VARIABLE = "FASTRTPS_DEFAULT_PROFILES_FILE"
DISCOVERY_VARIABLE = "ROS_AUTOMATIC_DISCOVERY_RANGE"
DOMAIN_VARIABLE = "ROS_DOMAIN_ID"
MIDDLEWARE = "rmw_fastrtps_cpp"
"""The only middleware that obeys the profile."""
NAMESPACE = "http://www.eprosima.com"
"""XML namespace of Fast DDS profiles."""
PAGE = "docs/operate/network.md"


@dataclass(frozen=True)
class Rule:
    """What becomes of an environment variable before the middleware starts.

    Attributes:
        decide: from its value (empty: not set) and whether the profile opens the network to the value in
            force (empty: not set). Raises a ConfigError if the node must not start.
        because: why what was set is not obeyed, where it is not.
    """

    decide: Callable[[str, bool], str]
    because: str


def enforce(environment: MutableMapping[str, str]) -> list[str]:
    """Put the variables in order that decide who can reach a node, before the middleware reads them.

    Args:
        environment: changed in place.

    Returns:
        A sentence for each variable that was set and is not obeyed.

    Raises:
        ConfigError: a variable has a value with which no node starts; it names both.
    """
    is_open = bool(allowed_addresses(environment) - {LOOPBACK})
    overruled = []
    for name, rule in RULES.items():
        given = environment.pop(name, "")
        if value := rule.decide(given, is_open):
            environment[name] = value
        if given not in ("", value):
            overruled.append(f"{name}={given} is not obeyed: {rule.because} ({PAGE})")
    return overruled


def check_bound() -> list[str]:
    """Make sure that the middleware of this process listens where the profile allows it, and nowhere else.

    Returns:
        The addresses at which other machines reach it; none in a closed cell.

    Raises:
        ConfigError: it listens elsewhere, or not where it should, or shares memory.
    """
    allowed, bound = allowed_addresses(os.environ), bound_addresses()
    opened = allowed - {LOOPBACK}
    # An open network is discovered by multicast; a closed one has no use for it.
    groups = {address for address in bound if opened and ip_address(address).is_multicast}
    profile = f"the profile of {PROFILE_VARIABLE} ({os.environ[PROFILE_VARIABLE]})"
    if wider := bound - allowed - groups:
        raise ConfigError(
            f"the middleware listens on {_listed(wider)}, but {profile} allows {_listed(allowed)} alone; "
            f"set no profile of your own, or one with these transports and no others ({PAGE})"
        )
    if missing := opened - bound:
        raise ConfigError(
            f"the network is not open: {profile} allows {_listed(missing)}, but the middleware does not "
            f"listen there; `--network` takes an interface that is up ({PAGE})"
        )
    if _shares_memory():
        raise ConfigError(f"the middleware shares memory with other processes; {profile} must not ({PAGE})")
    return sorted(opened)


def network_warning(opened: list[str]) -> str:
    """What it means that a cell is open at these addresses, in a sentence for the person at the terminal."""
    return (
        f"network open: every machine that reaches {', '.join(opened)} can hear this cell, reset it and "
        f"command its arm, without a password ({PAGE})"
    )


def bound_addresses() -> set[str]:
    """The local addresses that the UDP sockets of this process are bound to."""
    links = []
    for descriptor in Path("/proc/self/fd").iterdir():
        with suppress(FileNotFoundError):  # that of the listing itself, or one that a thread closes meanwhile
            links.append(str(descriptor.readlink()))
    inodes = {link[8:-1] for link in links if link.startswith("socket:[")}
    addresses = set()
    for table in ("udp", "udp6"):
        if not (path := Path("/proc/self/net", table)).exists():
            continue  # a system without IPv6
        for line in path.read_text().splitlines()[1:]:
            fields = line.split()  # proc_net_udp(5): local address at 1, inode at 9
            if fields[9] in inodes:
                addresses.add(_readable(fields[1].partition(":")[0]))
    return addresses


def allowed_addresses(environment: Mapping[str, str]) -> set[str]:
    """The addresses in the allow-list of the Fast DDS profile that the environment names.

    Raises:
        ConfigError: there is no such profile, or it allows other transports than UDP at listed addresses.
    """
    path = environment.get(PROFILE_VARIABLE, "")
    if not path:
        raise ConfigError(
            f"{PROFILE_VARIABLE} is not set, without which every machine reaches this node; it is set by "
            f"sourcing tools/env.sh, or local_setup.bash of the workspace ({PAGE})"
        )
    try:
        root = ElementTree.fromstring(Path(path).read_bytes())
    except OSError as error:
        raise ConfigError(
            f"{PROFILE_VARIABLE} is '{path}': {error.strerror}; source tools/env.sh in a shell that does not "
            f"set it ({PAGE})"
        ) from error
    except ElementTree.ParseError as error:
        raise ConfigError(f"{PROFILE_VARIABLE} is '{path}', which is no XML: {error}") from error
    transports = {element.text for element in root.iter(f"{{{NAMESPACE}}}type")}
    if others := {f"{name}" for name in transports} - {"UDPv4"}:
        raise ConfigError(
            f"{PROFILE_VARIABLE} is '{path}', with a transport {_listed(others)}; allowed: UDPv4 ({PAGE})"
        )
    lists = root.iter(f"{{{NAMESPACE}}}interfaceWhiteList")
    allowed = {f"{element.text}".strip() for found in lists for element in found}
    if not allowed:
        raise ConfigError(
            f"{PROFILE_VARIABLE} is '{path}', in which no interfaceWhiteList names an address; without one "
            f"every machine reaches this node ({PAGE})"
        )
    return allowed


def domain_in(environment: Mapping[str, str]) -> int | None:
    """The ROS domain id that the environment names; None if it names none.

    Raises:
        ConfigError: it is no whole number, or one whose ports others use.
    """
    given = environment.get(DOMAIN_VARIABLE, "").strip()
    if not given:
        return None
    if not (given.isascii() and given.isdecimal() and int(given) <= LAST_DOMAIN):
        raise ConfigError(f"{DOMAIN_VARIABLE} is '{given}'; allowed: 0 to {LAST_DOMAIN}")
    return int(given)


def _domain(given: str, _is_open: bool) -> str:
    domain = domain_in({DOMAIN_VARIABLE: given})
    return "" if domain is None else str(domain)


def _middleware(given: str, _is_open: bool) -> str:
    if given not in ("", MIDDLEWARE):
        installed = sorted(set(get_resources("rmw_typesupport")) - {"rmw_implementation"})
        raise ConfigError(
            f"RMW_IMPLEMENTATION is '{given}'; allowed: {MIDDLEWARE}, which alone obeys the profile that "
            f"decides who can reach a node; installed: {', '.join(installed)} ({PAGE})"
        )
    return MIDDLEWARE


def _discovery(given: str, is_open: bool) -> str:
    # Both leave the transports alone; SUBNET heeds ROS_STATIC_PEERS besides.
    return given if is_open and given in ("SUBNET", "SYSTEM_DEFAULT") else "SYSTEM_DEFAULT"


def _unset(_given: str, _is_open: bool) -> str:
    return ""


def _one(_given: str, _is_open: bool) -> str:
    return "1"


def _as_given(given: str, _is_open: bool) -> str:
    return given


def _only_if_open(given: str, is_open: bool) -> str:
    return given if is_open else ""


TRANSPORTS = "it would replace the transports; `--network` alone opens a cell"
SERVER = "nodes find each other without a discovery server; `--network` and ROS_STATIC_PEERS reach others"
OTHER_FILES = f"of profiles only that of {PROFILE_VARIABLE} counts"
QUALITY = "transport and quality of service are those of the code"
RULES = {
    # Its value has been read already: `allowed_addresses` refuses what cannot be used.
    PROFILE_VARIABLE: Rule(_as_given, ""),
    DOMAIN_VARIABLE: Rule(_domain, ""),
    "RMW_IMPLEMENTATION": Rule(_middleware, ""),
    DISCOVERY_VARIABLE: Rule(_discovery, TRANSPORTS),
    "ROS_LOCALHOST_ONLY": Rule(_unset, TRANSPORTS),
    "ROS_STATIC_PEERS": Rule(_only_if_open, "a closed cell reaches this machine alone"),
    "ROS_DISCOVERY_SERVER": Rule(_unset, SERVER),
    "ROS_SUPER_CLIENT": Rule(_unset, SERVER),
    "FASTDDS_BUILTIN_TRANSPORTS": Rule(_unset, TRANSPORTS),
    "FASTDDS_ENVIRONMENT_FILE": Rule(_unset, SERVER),
    "FASTDDS_DEFAULT_PROFILES_FILE": Rule(_unset, OTHER_FILES),
    # With 1 a file DEFAULT_FASTRTPS_PROFILES.xml in the working folder is not read.
    "SKIP_DEFAULT_XML_FILE": Rule(_one, OTHER_FILES),
    "SKIP_DEFAULT_XML": Rule(_one, OTHER_FILES),
    "RMW_FASTRTPS_USE_QOS_FROM_XML": Rule(_unset, QUALITY),
    "RMW_FASTRTPS_PUBLICATION_MODE": Rule(_unset, QUALITY),
}
"""All that librcl, rmw_fastrtps and Fast DDS (2.14; SKIP_DEFAULT_XML and FASTDDS_DEFAULT_PROFILES_FILE: 3)
read from the environment about transports and discovery."""


def _listed(addresses: set[str]) -> str:
    return ", ".join(sorted(addresses))


def _readable(word: str) -> str:
    if len(word) == 8:
        return socket.inet_ntoa(struct.pack("<I", int(word, 16)))
    # An IPv6 address is four words of the machine's byte order.
    parts = [struct.pack("<I", int(word[k : k + 8], 16)) for k in range(0, 32, 8)]
    return socket.inet_ntop(socket.AF_INET6, b"".join(parts))


def _shares_memory() -> bool:
    return "/dev/shm/fastrtps_" in Path("/proc/self/maps").read_text()
