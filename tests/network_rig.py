"""Two machines on one network, as two network namespaces, and what a process listens on."""

from __future__ import annotations

import os
import shutil
import socket
import struct
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from pack_core.network import DISCOVERY_VARIABLE, PROFILE_VARIABLE

PEER = Path(__file__).parent / "integration" / "network" / "peer.py"
HERE, THERE = "packcell_here", "packcell_there"
ADDRESSES = {HERE: "10.213.7.1", THERE: "10.213.7.2"}
OWN_MEMORY = "mount -t tmpfs tmpfs /dev/shm && exec "
"""Another machine does not share our memory."""
HEARD, NOT_HEARD = "heard", "not heard"
SILENCE = 6.0
"""Seconds after which a peer says that it has not heard another: several times what discovery takes."""
PATIENCE = 60.0
"""The same where the other is to be heard, on a busy machine, too."""


def bound_addresses() -> set[str]:
    """The local IPv4 addresses and IPv6 words that this process' UDP and TCP sockets are bound to."""
    links = [str(fd.readlink()) for fd in Path("/proc/self/fd").iterdir() if fd.is_symlink()]
    inodes = {link[8:-1] for link in links if link.startswith("socket:[")}
    addresses = set()
    for table in ("udp", "udp6", "tcp", "tcp6"):
        for line in Path("/proc/self/net", table).read_text().splitlines()[1:]:
            fields = line.split()
            if fields[9] in inodes:
                addresses.add(_readable(fields[1].partition(":")[0]))
    return addresses


def shared_memory_of_the_middleware() -> set[str]:
    """The files through which this process shares memory with others by Fast DDS."""
    mapped = (line.split()[-1] for line in Path("/proc/self/maps").read_text().splitlines())
    return {path for path in mapped if path.startswith("/dev/shm/fastrtps_")}


def _readable(word: str) -> str:
    return socket.inet_ntoa(struct.pack("<I", int(word, 16))) if len(word) == 8 else word


@contextmanager
def two_machines() -> Iterator[None]:
    """Two network namespaces joined by a cable, as two machines on one network are."""
    if os.geteuid() != 0 or not shutil.which("ip"):
        pytest.skip("network namespaces need root and the command `ip`")
    commands = [f"netns add {name}" for name in ADDRESSES]
    commands += [f"link add {HERE} netns {HERE} type veth peer name {THERE} netns {THERE}"]
    for name, address in ADDRESSES.items():
        commands += [f"-n {name} address add {address}/24 dev {name}"]
        commands += [f"-n {name} link set {device} up" for device in ("lo", name)]
    try:
        for command in commands:
            done = subprocess.run(["ip", *command.split()], capture_output=True, text=True, check=False)
            if done.returncode:
                pytest.skip(f"no network namespaces here: ip {command}: {done.stderr.strip()}")
        yield
    finally:
        for name in ADDRESSES:
            subprocess.run(["ip", "netns", "delete", name], capture_output=True, check=False)


def on_machine(machine: str, *command: str) -> list[str]:
    """The command line with which a command runs on one of the two machines."""
    own = ["ip", "netns", "exec", machine, "unshare", "--mount", "sh", "-c", OWN_MEMORY + '"$@"', "sh"]
    return [*own, *command]


def start(
    machine: str, environment: dict[str, str], *interface: str, seconds: float = SILENCE
) -> subprocess.Popen[str]:
    """A peer that publishes on a machine; ask `who_heard` whether it has heard another."""
    command = on_machine(machine, sys.executable, str(PEER), machine, str(seconds), *interface)
    pipe = subprocess.PIPE
    return subprocess.Popen(
        command, env=environment | {"ROS_DOMAIN_ID": "0"}, stdin=pipe, stdout=pipe, text=True
    )


def who_heard(*peers: subprocess.Popen[str]) -> list[str]:
    """`HEARD` or `NOT_HEARD` of each peer; all of them publish until the last one has said so."""
    answers = [peer.stdout.readline().strip() for peer in peers if peer.stdout]
    for peer in peers:
        peer.communicate()  # closes its standard input, which ends it
    return answers


def without_profile(discovery_range: str) -> dict[str, str]:
    environment = {name: value for name, value in os.environ.items() if name != PROFILE_VARIABLE}
    return environment | {DISCOVERY_VARIABLE: discovery_range}


def stranger(seconds: float = SILENCE) -> subprocess.Popen[str]:
    """A machine on the network that names ours as its static peer, without any profile."""
    environment = without_profile("SUBNET") | {"ROS_STATIC_PEERS": ADDRESSES[HERE]}
    return start(THERE, environment, seconds=seconds)
