"""A node in somebody's shell: closed whatever is set there, or ended with the name of what is set."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from integration.harness import own_domain
from pack_core.network import PROFILE_VARIABLE

NODE = """
import sys
from rclpy.node import Node
from network_rig import bound_addresses, shared_memory_of_the_middleware
from pack_core.ros.run import run_node

def make():
    node = Node("node_of_its_own")
    print(*sorted(bound_addresses()), *shared_memory_of_the_middleware(), flush=True)
    node.create_timer(0.0, lambda: sys.exit(0))
    return node

sys.exit(run_node(make))
"""
OPEN = """<dds xmlns="http://www.eprosima.com"><profiles>
<transport_descriptors><transport_descriptor><transport_id>unused</transport_id><type>UDPv4</type>
<interfaceWhiteList><address>127.0.0.1</address></interfaceWhiteList>
</transport_descriptor></transport_descriptors>
<participant profile_name="open" is_default_profile="true"><rtps>
<useBuiltinTransports>true</useBuiltinTransports></rtps></participant></profiles></dds>"""
"""A profile that has an allow-list, which its participant does not use."""


def node_with(folder: Path, **environment: str) -> subprocess.CompletedProcess[str]:
    """What a node says that is started in a folder, with variables over those of the test."""
    tests = str(Path(__file__).parents[2])
    given = {**os.environ, "ROS_DOMAIN_ID": str(own_domain()), "PYTHONPATH": tests, **environment}
    given["PYTHONPATH"] = os.pathsep.join((tests, os.environ.get("PYTHONPATH", "")))
    return subprocess.run(
        [sys.executable, "-c", NODE], capture_output=True, text=True, check=False, env=given, cwd=folder
    )


@pytest.mark.parametrize(
    "variable",
    [
        "ROS_LOCALHOST_ONLY=1", "ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST", "ROS_STATIC_PEERS=192.0.2.9",
        "ROS_DISCOVERY_SERVER=192.0.2.9:11811", "FASTDDS_BUILTIN_TRANSPORTS=DEFAULT",
    ],
)  # fmt: skip
def test_a_variable_that_would_open_a_node_is_overruled_by_name(variable: str, tmp_path: Path) -> None:
    name, _, value = variable.partition("=")
    process = node_with(tmp_path, **{name: value})
    assert (process.returncode, process.stdout) == (0, "127.0.0.1\n"), process.stderr
    assert f"warning: {variable} is not obeyed" in process.stderr


def test_a_profile_in_the_working_folder_is_not_read(tmp_path: Path) -> None:
    (tmp_path / "DEFAULT_FASTRTPS_PROFILES.xml").write_text(OPEN)
    process = node_with(tmp_path)
    assert (process.returncode, process.stdout) == (0, "127.0.0.1\n"), process.stderr


@pytest.mark.parametrize("variable", [f"{PROFILE_VARIABLE}=/nowhere.xml", "ROS_DOMAIN_ID=abc"])
def test_a_node_ends_with_the_name_of_a_variable_that_it_cannot_start_with(
    variable: str, tmp_path: Path
) -> None:
    name, _, value = variable.partition("=")
    process = node_with(tmp_path, **{name: value})
    assert (process.returncode, process.stdout) == (2, "")
    assert f"error: {name} is '{value}'" in process.stderr


def test_a_node_that_listens_wider_than_its_profile_allows_ends(tmp_path: Path) -> None:
    (tmp_path / "open.xml").write_text(OPEN)
    process = node_with(tmp_path, **{PROFILE_VARIABLE: str(tmp_path / "open.xml")})
    assert process.returncode == 2
    assert "error: the middleware listens on 0.0.0.0" in process.stderr
    assert PROFILE_VARIABLE in process.stderr
