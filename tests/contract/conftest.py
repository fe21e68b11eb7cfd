"""Which driver the contract tests run against: the simulator's, or one that is named on the command line."""

from __future__ import annotations

import os
import shlex
import signal
import subprocess
from collections.abc import Iterator
from contextlib import suppress

import pytest

from contract.driver_rig import DriverRig
from integration.harness import Graph, own_domain
from integration.packing.sim_rig import EXAMPLE
from pack_core.packing.cell import packing_cell
from pack_core.robots.packing_arms import PACKING_ARMS

SLOW = 0.25
"""Real-time factor of the simulator: a busy machine that halts the test for 0.2 s halts it for 50 ms of the
driver's time, half of what the watchdog allows."""
SIMULATOR = f"pack run pack_sim sim_node --ros-args -p scene:={EXAMPLE} -p real_time_factor:={SLOW}"
END_TIME = 10.0
"""For which a driver may take to end after an interrupt [s]."""


def pytest_addoption(parser: pytest.Parser) -> None:
    """Options of `pytest tests/contract`."""
    group = parser.getgroup("driver", "the driver under test (docs/cells/packing/driver.md)")
    group.addoption("--driver", help="command that starts it; default: the packing cell's simulator")
    group.addoption("--driver-domain", type=int, help="ROS domain on which it runs already; starts nothing")
    group.addoption("--driver-name", help="its node's name in /diagnostics and /alive; default: sim")
    group.addoption("--driver-arm", choices=list(PACKING_ARMS), help="its arm; default: the cell's")


@pytest.fixture(scope="module")
def driver_domain(pytestconfig: pytest.Config) -> Iterator[int]:
    """The ROS domain on which the driver runs, for all tests: a robot is not started anew for each."""
    running = pytestconfig.getoption("--driver-domain", None)
    if running is not None:
        yield running
        return
    domain = own_domain()
    command = shlex.split(pytestconfig.getoption("--driver", None) or SIMULATOR)
    # In a session of its own, so that the interrupt reaches what the command starts, too, and nothing else.
    driver = subprocess.Popen(
        command, env=os.environ | {"ROS_DOMAIN_ID": str(domain)}, start_new_session=True
    )
    yield domain
    with suppress(ProcessLookupError):
        os.killpg(driver.pid, signal.SIGINT)
    try:
        driver.wait(END_TIME)
    except subprocess.TimeoutExpired:
        os.killpg(driver.pid, signal.SIGKILL)
        driver.wait()


@pytest.fixture
def rig(pytestconfig: pytest.Config, driver_domain: int) -> Iterator[DriverRig]:
    """A sender of setpoints and a probe beside the driver, whose arm is at rest."""
    graph = Graph(driver_domain)
    arm = PACKING_ARMS[pytestconfig.getoption("--driver-arm", None) or packing_cell().robot.model]
    rig = DriverRig(graph, arm, pytestconfig.getoption("--driver-name", None) or "sim")
    try:
        rig.wait_for_driver()
        yield rig
    finally:
        graph.close()
