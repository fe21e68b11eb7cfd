"""Cells operated from the page in a real browser: started by its button, stopped, told of a dead node."""

import json
import signal
import socket
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from integration.harness import Graph
from pack_bringup.graph.graph import load_graph
from pack_bringup.graph.processes import ProcessGroup
from pack_bringup.viewers import PageProcess
from pack_core.ros.contracts import shared
from pack_core.ros.contracts.table import wiring_of
from page_browser import PageInBrowser, open_page

JOINT_STATES = "/joint_states"
FACTOR = 0.3
"""Real-time factor: browser and cell share two cores."""
UP = 150.0
STANDING = 0.01
"""A joint slower than this stands [rad/s]."""


@pytest.fixture
def graph() -> Iterator[Graph]:
    """An empty graph on a domain of its own."""
    opened = Graph()
    yield opened
    opened.close()


@dataclass
class ShownCell:
    """A running cell with its page."""

    graph: Graph
    processes: ProcessGroup
    address: str

    @property
    def speed(self) -> float:
        """Of the fastest joint by the newest message [rad/s]."""
        heard = self.graph.probe.mail[JOINT_STATES]
        return float(np.abs(heard[-1].velocity).max()) if heard else 0.0

    @property
    def is_standing(self) -> bool:
        """Whether the arm stands after a stop."""
        heard = self.graph.probe.mail[shared.ARM_STATE.name]
        return bool(heard) and heard[-1].is_stopped and heard[-1].is_standing


@contextmanager
def shown(cell: str, graph: Graph, folder: Path) -> Iterator[ShownCell]:
    """The cell's nodes as processes, the page among them."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    overrides = {
        "sim": {"real_time_factor": str(FACTOR)},
        "recorder": {"path": json.dumps(str(folder)), "cell": json.dumps(cell)},
    }
    commands = load_graph(cell).commands(overrides) | PageProcess(cell, port).commands()
    environment = {"ROS_DOMAIN_ID": str(graph.context.get_domain_id())}
    wiring = {contract.name: contract for contract in wiring_of(cell)}
    graph.probe.listen(wiring[JOINT_STATES], shared.ARM_STATE)
    with (folder / "nodes.log").open("w") as log:
        processes = ProcessGroup(commands, environment=environment, output=log)
        with processes:
            graph.wait_until_ready(*commands, timeout=UP)
            yield ShownCell(graph, processes, f"http://127.0.0.1:{port}")


def stop_in_the_middle(browser: PageInBrowser, cell: ShownCell) -> None:
    """Press STOP while the arm moves, and see it stand."""
    cell.graph.wait_until(lambda: cell.speed > 10 * STANDING, UP)
    browser.press("STOP")
    cell.graph.wait_until(lambda: cell.is_standing, UP)
    assert cell.speed < STANDING
    browser.wait_for_text("the arm is stopped")


@pytest.mark.e2e
@pytest.mark.long
@pytest.mark.alone
@pytest.mark.timeout(500)
def test_a_packing_goal_is_started_stopped_and_run_again_and_a_dead_node_is_seen(
    graph: Graph, tmp_path: Path
) -> None:
    with shown("packing", graph, tmp_path) as cell, open_page(cell.address) as browser:
        browser.press("start")
        browser.wait_for_headline("PRE-PACK")
        assert not browser.can_press("start")
        assert browser.can_press("cancel")
        stop_in_the_middle(browser, cell)
        browser.wait_for_headline("fault")
        browser.press("start")  # a new goal ends the stop
        browser.wait_for_headline("PRE-PACK")
        browser.press("pause")  # so that the goal lasts until both pages have been loaded
        browser.page.reload()
        browser.wait_for_text("paused")
        window = browser.page.context.browser
        assert window is not None
        other = PageInBrowser(window.new_page())
        other.page.goto(cell.address)
        other.wait_for_text("paused")  # both are told the same
        other.press("go on")
        other.wait_for_text("a goal is in progress")
        browser.press("cancel")
        other.page.close()
        browser.wait_for_headline("canceled")
        cell.processes.signal("planner", signal.SIGKILL)
        browser.wait_for_text("planner: silent")
        assert browser.foreign_requests == []


@pytest.mark.e2e
@pytest.mark.long
@pytest.mark.alone
@pytest.mark.timeout(500)
def test_a_container_is_filled_stopped_and_filled_again(graph: Graph, tmp_path: Path) -> None:
    with shown("packing", graph, tmp_path) as cell, open_page(cell.address) as browser:
        browser.choose("pack one object", "fill a container")
        browser.choose("8 objects drawn by the seed", "example")
        browser.press("start")
        browser.page.get_by_role("tab", name="Fill").click()
        browser.wait_for_headline("pick")
        browser.wait_for_text("1 of 3")  # packed
        stop_in_the_middle(browser, cell)
        browser.wait_for_headline("fault")
        browser.press("start")  # with an empty container again
        browser.wait_for_text("0 of 3")
        browser.wait_for_headline("pick")
        browser.press("cancel")
        browser.wait_for_headline("canceled")
        assert browser.foreign_requests == []


@pytest.mark.e2e
@pytest.mark.long
@pytest.mark.alone
@pytest.mark.timeout(400)
@pytest.mark.parametrize(("cell_name", "moving"), [("palletizing", "detect"), ("blocks", "PICK")])
def test_a_goal_is_started_and_stopped(graph: Graph, tmp_path: Path, cell_name: str, moving: str) -> None:
    with shown(cell_name, graph, tmp_path) as cell, open_page(cell.address) as browser:
        browser.press("start")
        browser.wait_for_headline(moving)
        stop_in_the_middle(browser, cell)
        assert browser.foreign_requests == []
