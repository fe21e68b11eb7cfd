"""Opens a cell to other machines, which it is closed to unless asked for (docs/operate/network.md)."""

from __future__ import annotations

import fcntl
import socket
import struct
import tempfile
from pathlib import Path
from xml.etree import ElementTree

from ament_index_python.packages import get_package_share_directory

from pack_core.errors import PackError
from pack_core.network import DISCOVERY_VARIABLE, NAMESPACE, PROFILE_VARIABLE

SIOCGIFADDR = 0x8915
"""The request that asks Linux for an interface's IPv4 address (netdevice(7))."""


def network_environment(interface: str) -> dict[str, str]:
    """Environment variables with which nodes talk over one network interface, beside this machine itself.

    Args:
        interface: name of a network interface that has an IPv4 address, e.g. `eth0`.

    Raises:
        PackError: there is no such interface, or it has no IPv4 address.
    """
    profile = _profile_path(address_of(interface))
    return {PROFILE_VARIABLE: str(profile), DISCOVERY_VARIABLE: "SUBNET"}


def address_of(interface: str) -> str:
    """The IPv4 address of a network interface of this machine.

    Raises:
        PackError: there is no such interface, or it has no IPv4 address.
    """
    known = [name for _, name in socket.if_nameindex()]
    if interface not in known:
        raise PackError(f"no network interface '{interface}'; this machine has: {', '.join(known)}")
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            answer = fcntl.ioctl(probe, SIOCGIFADDR, struct.pack("256s", interface.encode()))
        except OSError as error:
            raise PackError(f"network interface '{interface}' has no IPv4 address") from error
    return socket.inet_ntoa(
        answer[20:24]
    )  # struct ifreq: 16 bytes of name, then sockaddr_in with its address at 4


def _profile_path(address: str) -> Path:
    """A copy of the loopback profile that allows `address`, too, and discovers by multicast."""
    ElementTree.register_namespace("", NAMESPACE)
    tree = ElementTree.parse(Path(get_package_share_directory("pack_bringup"), "network", "loopback.xml"))
    allowed = _only(tree.getroot(), "interfaceWhiteList")
    ElementTree.SubElement(allowed, f"{{{NAMESPACE}}}address").text = address
    rtps = _only(tree.getroot(), "rtps")
    rtps.remove(_only(rtps, "builtin"))
    # In a folder of our own: whoever could write a file of a known name in /tmp would open the network wider.
    path = Path(tempfile.mkdtemp(prefix="packcell_"), "network.xml")
    tree.write(path, encoding="UTF-8", xml_declaration=True)
    return path


def _only(element: ElementTree.Element, tag: str) -> ElementTree.Element:
    (found,) = element.iter(f"{{{NAMESPACE}}}{tag}")
    return found
