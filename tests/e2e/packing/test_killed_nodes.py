"""Any node may be killed at any time: the arm stops, the others say so, the recording survives."""

import pytest

from e2e.packing.cell import Cell
from pack_evaluation.bag import read_bag

pytestmark = [pytest.mark.e2e, pytest.mark.alone, pytest.mark.timeout(400)]
WATCHERS = {
    "sim": ("perception", "planner", "mpc", "recorder"),
    "perception": ("planner", "mpc", "recorder"),
    "planner": ("mpc", "recorder"),
    "mpc": ("sim", "recorder"),
    "recorder": ("mpc",),
}
ALWAYS = ("recorder",)
"""The node that writes, without which a goal ends, too; the others take minutes more, in `make slow`. That
the arm stops without the node that commands it is tested in one process, by
tests/integration/packing/test_mpc_node.py, and with the driver as a process by tests/contract."""
STOP_TIME = 0.1
"""Simulated time in which the arm stops [s]."""
STILL = 0.05
"""Speed of a joint that counts as none [rad/s]."""
LOST = 0.3
"""Simulated time that a killed recorder may lose: a second of wall clock [s]."""


@pytest.mark.parametrize(
    "victim", [pytest.param(name, marks=() if name in ALWAYS else pytest.mark.long) for name in WATCHERS]
)
def test_when_a_node_is_killed_the_arm_stops_the_others_report_it_and_the_bag_is_readable(
    cell: Cell, victim: str
) -> None:
    heard = cell.time
    cell.graph.wait_until(lambda: cell.newest_recorded() > heard, 30.0)
    cell.start_goal()
    cell.graph.wait_until(lambda: cell.speed > 0.2, 30.0)
    killed_ns = cell.kill(victim)
    for watcher in WATCHERS[victim]:
        cell.graph.wait_until(lambda name=watcher: cell.has_reported(name, f"'{victim}' is silent"), 5.0)
    if victim != "sim":
        cell.graph.wait_until(lambda: cell.time > cell.simulated(killed_ns) + 0.3, 10.0)
        times, speeds = cell.speeds()
        since = times - cell.simulated(killed_ns)
        late = speeds[(since > STOP_TIME) & (since < 0.3)]
        assert late.size
        assert late.max() < STILL
    cell.processes.stop()
    bag = read_bag(cell.folder)
    assert bag.is_cut == (victim == "recorder")
    assert cell.newest_recorded() > cell.simulated(killed_ns) - LOST
