"""Which drivers the contract tests run against: those at hand, or one that is named on the command line."""

from __future__ import annotations

import os
import shlex
import signal
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass

import pytest

from contract.driver_rig import DriverRig
from contract.position_rig import PositionRig
from foreign_driver.driver_nodes import ACTION
from integration.harness import Graph, own_domain
from integration.packing.sim_rig import EXAMPLE
from pack_core.cells import CELLS
from pack_core.packing.cell import packing_cell
from pack_core.paths import project_root
from pack_core.robots.packing_arms import PACKING_ARMS

SLOW = 0.25
"""Real-time factor of the simulator: a busy machine that halts the test for 0.2 s halts it for 50 ms of the
driver's time, half of what the watchdog allows."""
SIMULATOR = f"pack run pack_sim sim_node --ros-args -p scene:={EXAMPLE} -p real_time_factor:={SLOW}"
RELAYED = f"python -m foreign_driver packing --ros-args -p scene:={EXAMPLE} -p real_time_factor:={SLOW}"
"""The tests' own controller behind the relay."""
WHAT_THE_RELAY_DOES = (
    "test_what_comes_last_counts_also_when_its_stamp_is_earlier",
    "test_it_stops_when_the_sender_dies_and_follows_the_next_one",
    "test_bad_setpoints_neither_move_nor_end_it_and_are_counted",
)
"""Tests that run against the relay, too; all of them pass there, in a minute
(`--driver "python -m foreign_driver packing" --driver-name relay`)."""
END_TIME = 10.0
"""For which a driver may take to end after an interrupt [s]."""


@dataclass(frozen=True)
class PositionDriver:
    """A driver of an arm that is led along positions.

    Attributes:
        cell: whose arm it is.
        command: that starts it; empty: it runs already.
        action: that takes trajectories; empty: it takes setpoints.
        name: of its node.
    """

    cell: str
    command: str
    action: str = ""
    name: str = "sim"


PACE = "--ros-args -p real_time_factor:=0.3"
"""Of a driver that is led for 0.2 s ahead: a busy machine may halt the test for 0.6 s."""
AT_HAND = (
    PositionDriver("palletizing", f"pack run pack_sim pallet_sim_node {PACE}"),
    PositionDriver("palletizing", f"python -m foreign_driver palletizing {PACE}", ACTION),
)
ALSO_AT_HAND = (
    PositionDriver("blocks", f"pack run pack_sim blocks_sim_node {PACE}"),
    PositionDriver("blocks", f"python -m foreign_driver blocks {PACE}", ACTION),
)
"""Run by `make slow`: the palletizing arm has the same node and the same controller. They move and stop the
arm of blocks in tests/integration/blocks, test_blocks_stop.py and test_trajectories.py."""


def pytest_addoption(parser: pytest.Parser) -> None:
    """Options of `pytest tests/contract`."""
    group = parser.getgroup("driver", "the driver under test (docs/operate/driver.md)")
    group.addoption("--driver", help="command that starts it; default: those at hand, of all cells")
    group.addoption("--driver-domain", type=int, help="ROS domain on which it runs already; starts nothing")
    group.addoption("--driver-name", help="its node's name in /diagnostics and /alive; default: sim")
    group.addoption("--driver-cell", choices=CELLS, help="the cell whose arm it drives; default: packing")
    group.addoption("--driver-arm", choices=list(PACKING_ARMS), help="its arm; default: the packing cell's")
    group.addoption("--driver-action", help="its action for trajectories; default: it takes setpoints")


def named(config: pytest.Config) -> PositionDriver | None:
    """The driver that the command line names, if it names one."""
    command, domain = (config.getoption(name, None) for name in ("--driver", "--driver-domain"))
    if command is None and domain is None:
        return None
    cell, action, name = (config.getoption(f"--driver-{what}", None) for what in ("cell", "action", "name"))
    return PositionDriver(cell or "packing", command or "", action or "", name or "sim")


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """Run the tests against each driver that they are for."""
    if "rig" in metafunc.fixturenames:
        is_for_both = metafunc.function.__name__ in WHAT_THE_RELAY_DOES and named(metafunc.config) is None
        drivers = {"simulator": SIMULATOR, "relay": RELAYED} if is_for_both else {"simulator": SIMULATOR}
        metafunc.parametrize(
            "driver_domain", list(drivers.values()), ids=list(drivers), scope="module", indirect=True
        )
    if "position_driver" in metafunc.fixturenames:
        own = named(metafunc.config)
        drivers = AT_HAND + ALSO_AT_HAND if own is None else tuple({own} if own.cell != "packing" else ())
        params = [
            pytest.param(
                driver, marks=pytest.mark.long if driver in ALSO_AT_HAND else (),
                id=f"{driver.cell}-{'trajectories' if driver.action else 'setpoints'}",
            )
            for driver in drivers
        ]  # fmt: skip
        metafunc.parametrize("position_driver", params, scope="module", indirect=True)


@contextmanager
def driver_on_domain(config: pytest.Config, command: str) -> Iterator[int]:
    """The ROS domain on which a driver runs: one that `command` is started on, or the one that is named."""
    running = config.getoption("--driver-domain", None)
    if running is not None:
        yield running
        return
    domain = own_domain()
    paths = os.pathsep.join([str(project_root() / "tests"), os.environ.get("PYTHONPATH", "")])
    # In a session of its own, so that the interrupt reaches what the command starts, too, and nothing else.
    driver = subprocess.Popen(
        shlex.split(command), env=os.environ | {"ROS_DOMAIN_ID": str(domain), "PYTHONPATH": paths},
        start_new_session=True,
    )  # fmt: skip
    yield domain
    with suppress(ProcessLookupError):
        os.killpg(driver.pid, signal.SIGINT)
    try:
        driver.wait(END_TIME)
    except subprocess.TimeoutExpired:
        os.killpg(driver.pid, signal.SIGKILL)
        driver.wait()


@pytest.fixture(scope="module")
def driver_domain(request: pytest.FixtureRequest, pytestconfig: pytest.Config) -> Iterator[tuple[str, int]]:
    """The packing cell's driver and its ROS domain, for all tests: a robot is not started anew for each."""
    own = named(pytestconfig)
    if own is not None and own.cell != "packing":
        pytest.skip(f"the driver under test drives the arm of the {own.cell} cell")
    name = pytestconfig.getoption("--driver-name", None) or ("relay" if request.param == RELAYED else "sim")
    with driver_on_domain(pytestconfig, own.command if own else request.param) as domain:
        yield name, domain


@pytest.fixture(scope="module")
def position_driver(
    request: pytest.FixtureRequest, pytestconfig: pytest.Config
) -> Iterator[tuple[PositionDriver, int]]:
    """A driver of an arm that is led along positions, and its ROS domain; it runs for all tests."""
    with driver_on_domain(pytestconfig, request.param.command) as domain:
        yield request.param, domain


@pytest.fixture
def position_rig(position_driver: tuple[PositionDriver, int]) -> Iterator[PositionRig]:
    """What leads the arm, beside the driver, whose arm is at rest."""
    driver, domain = position_driver
    graph = Graph(domain)
    rig = PositionRig(graph, driver.cell, driver.name, driver.action)
    try:
        rig.wait_for_driver()
        yield rig
    finally:
        rig.close()
        graph.close()


@pytest.fixture
def rig(pytestconfig: pytest.Config, driver_domain: tuple[str, int]) -> Iterator[DriverRig]:
    """A sender of setpoints and a probe beside the driver, whose arm is at rest."""
    name, domain = driver_domain
    graph = Graph(domain)
    arm = PACKING_ARMS[pytestconfig.getoption("--driver-arm", None) or packing_cell().robot.model]
    rig = DriverRig(graph, arm, name)
    try:
        rig.wait_for_driver()
        yield rig
    finally:
        graph.close()
