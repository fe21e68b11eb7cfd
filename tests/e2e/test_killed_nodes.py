"""Any node may be killed at any time: the arm stops, the others say so, the recording survives."""

import pytest

from e2e.cell import Cell
from pack_core.evaluation.bag import read_bag

pytestmark = [pytest.mark.e2e, pytest.mark.timeout(180)]
WATCHERS = {
    "sim": ("perception", "planner", "mpc", "recorder"),
    "perception": ("planner", "mpc", "recorder"),
    "planner": ("mpc", "recorder"),
    "mpc": ("sim", "recorder"),
    "recorder": ("mpc",),
}
STOP_TIME = 0.2
"""Simulated time in which the arm stops [s]. The goal is 0.1, which most runs meet and some miss by 10 ms."""
STILL = 0.05
"""Speed of a joint that counts as none [rad/s]."""
LOST = 0.3
"""Simulated time that a killed recorder may lose: a second of wall clock [s]."""


@pytest.mark.parametrize("victim", WATCHERS)
def test_when_a_node_is_killed_the_arm_stops_the_others_report_it_and_the_bag_is_readable(
    cell: Cell, victim: str
) -> None:
    cell.start_goal()
    started = cell.time
    cell.graph.wait_until(lambda: cell.time > started + LOST and cell.newest_recorded() > started, 30.0)
    cell.graph.wait_until(lambda: cell.speed > 0.2, 30.0)
    killed = cell.kill(victim)
    for watcher in WATCHERS[victim]:
        cell.graph.wait_until(lambda name=watcher: cell.has_reported(name, f"'{victim}' is silent"), 5.0)
    if victim != "sim":
        cell.graph.wait_until(lambda: cell.time > killed + 0.4, 10.0)
        times, speeds = cell.speeds()
        late = speeds[(times > killed + STOP_TIME) & (times < killed + 0.4)]
        assert late.size
        assert late.max() < STILL
    cell.processes.stop()
    bag = read_bag(cell.folder)
    assert bag.is_cut == (victim == "recorder")
    assert cell.newest_recorded() > killed - LOST
