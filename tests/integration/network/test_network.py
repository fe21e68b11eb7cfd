"""Nothing of ours can be reached from another machine, unless it is opened deliberately."""

import os
import subprocess
import sys
from collections.abc import Iterator

import pytest

import network_rig
from integration.harness import Graph
from network_rig import (
    ADDRESSES,
    HEARD,
    HERE,
    NOT_HEARD,
    PATIENCE,
    THERE,
    bound_addresses,
    shared_memory_of_the_middleware,
    start,
    stranger,
    who_heard,
    without_profile,
)
from pack_bringup.graph.network import network_environment
from pack_bringup.recording.playback import load_playback
from pack_bringup.recording.ros.bag_player import BagPlayer
from pack_bringup.robustness.ros.cell_observer import CellObserver
from pack_core.errors import PackError
from pack_core.network import network_warning
from pack_core.paths import bags_path

SHARES = """
import sys, rclpy
rclpy.init()
node = rclpy.create_node("node_of_its_own")
sys.exit("/dev/shm/fastrtps_" not in open("/proc/self/maps").read())
"""


def test_all_sockets_of_a_node_are_bound_to_loopback(graph: Graph) -> None:
    graph.wait_until(lambda: graph.probe.count_publishers("/rosout"))
    assert bound_addresses() == {"127.0.0.1"}


def test_a_node_shares_no_memory_whose_locks_a_killed_process_would_keep(graph: Graph) -> None:
    graph.wait_until(lambda: graph.probe.count_publishers("/rosout"))
    assert not shared_memory_of_the_middleware()


def test_without_the_profile_a_node_shares_memory() -> None:
    """That the test above would notice it."""
    command = [sys.executable, "-c", SHARES]
    assert not subprocess.run(command, env=without_profile("LOCALHOST"), check=False).returncode


def test_all_sockets_of_pack_play_are_bound_to_loopback(graph: Graph) -> None:
    playback = load_playback(bags_path() / "samples" / "packing", ["/joint_states"], end=2.0)
    with BagPlayer(playback, clock=True, stand_in=("sim",), domain=graph.context.get_domain_id()):
        graph.wait_until(lambda: graph.probe.count_publishers("/joint_states"))
        assert bound_addresses() == {"127.0.0.1"}


def test_all_sockets_of_what_watches_in_benchmarks_of_running_cells_are_bound_to_loopback(
    graph: Graph,
) -> None:
    with CellObserver("packing", graph.context.get_domain_id()):
        graph.wait_until(lambda: graph.probe.count_subscribers("/joint_states"))
        assert bound_addresses() == {"127.0.0.1"}


@pytest.fixture(scope="module")
def two_machines() -> Iterator[None]:
    """For the tests of this file; skipped where there are no network namespaces."""
    with network_rig.two_machines():
        yield


@pytest.mark.usefixtures("two_machines")
def test_a_machine_that_names_ours_as_its_peer_neither_hears_nor_is_heard() -> None:
    assert who_heard(start(HERE, dict(os.environ)), stranger()) == [NOT_HEARD, NOT_HEARD]


@pytest.mark.usefixtures("two_machines")
def test_a_variable_that_would_open_a_cell_does_not() -> None:
    ours = start(HERE, {**os.environ, "ROS_LOCALHOST_ONLY": "1", "ROS_STATIC_PEERS": ADDRESSES[THERE]})
    assert who_heard(ours, stranger()) == [NOT_HEARD, NOT_HEARD]


@pytest.mark.usefixtures("two_machines")
@pytest.mark.parametrize("variable", ["ROS_LOCALHOST_ONLY=1", "ROS_DISCOVERY_SERVER=192.0.2.9:11811"])
def test_a_variable_that_would_keep_an_opened_cell_closed_does_not(variable: str) -> None:
    name, _, value = variable.partition("=")
    ours = start(HERE, {**os.environ, name: value}, HERE, seconds=PATIENCE)
    assert who_heard(ours, stranger(PATIENCE)) == [HEARD, HEARD]


@pytest.mark.usefixtures("two_machines")
def test_an_opened_cell_is_heard() -> None:
    ours = start(HERE, dict(os.environ), HERE, seconds=PATIENCE)
    assert who_heard(ours, stranger(PATIENCE)) == [HEARD, HEARD]


@pytest.mark.usefixtures("two_machines")
def test_without_the_profile_a_peer_on_the_network_is_heard() -> None:
    ours = start(HERE, without_profile("LOCALHOST"), seconds=PATIENCE)
    assert who_heard(ours, stranger(PATIENCE)) == [HEARD, HEARD]


def test_opening_says_what_it_opens() -> None:
    assert "command its arm" in network_warning(["192.0.2.2"])
    assert "192.0.2.2" in network_warning(["192.0.2.2"])


def test_an_unknown_interface_is_refused_with_those_that_exist() -> None:
    with pytest.raises(PackError, match=r"no network interface 'eth99'; this machine has: .*lo"):
        network_environment("eth99")
