"""Processor time of the page's node while a recording of each cell is played to it at real time.

`pytest -m benchmark -s tests/benchmarks/test_page_cost.py` records a run of each cell, plays it with one
browser open, and prints a line for each cell. The browser's own time is not counted.
"""

from __future__ import annotations

import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from statistics import median

import numpy as np
import pytest
from pytest_benchmark.fixture import BenchmarkFixture
from rosbags.highlevel import AnyReader

from benchmarks.ports import free_port, wait_for_port
from benchmarks.processor_time import processor_time
from pack_bringup.graph.processes import ProcessGroup
from pack_bringup.graph.running import choose_domain
from pack_bringup.viewers import PageProcess
from pack_core.paths import project_root
from page_browser import open_page

pytestmark = pytest.mark.benchmark
BOUNDS = {"packing": 8.0, "palletizing": 10.0, "blocks": 8.0}
"""Of the page's node [% of a core]."""
DEMOS = {
    "packing": [],
    "palletizing": ["--order", str(project_root() / "config" / "orders" / "order_17.json")],
    "blocks": ["--blocks", "2"],
}
"""What `pack demo` is told, to have a short run of each cell."""


@pytest.mark.timeout(1200)
@pytest.mark.parametrize(("cell", "bound"), BOUNDS.items())
def test_the_page_costs_little_at_real_time(
    benchmark: BenchmarkFixture, cell: str, bound: float, tmp_path: Path
) -> None:
    folder = tmp_path / cell
    subprocess.run(["pack", "demo", cell, *DEMOS[cell], "--no-video", "-o", str(folder)], check=True)
    cost = benchmark.pedantic(lambda: cost_of_playing(cell, folder / "bag", tmp_path), rounds=1)
    sys.stdout.write(
        f"\n{cell:12}{cost.share:6.1f} % of a core (median second), {cost.mean:.1f} % on average, "
        f"with the scene's first drawing; first picture after {cost.first_picture:.1f} s\n"
    )
    assert cost.share <= bound


@dataclass(frozen=True)
class Cost:
    """What the page's node took while a recording was played.

    Attributes:
        share: of a core, in the median second of the recording [%].
        mean: of a core, over the whole recording, the building of its scene included [%].
        first_picture: when a browser that opened the page had drawn the scene [s].
    """

    share: float
    mean: float
    first_picture: float


def cost_of_playing(cell: str, bag: Path, folder: Path) -> Cost:
    """Play a recording to a page that a browser shows."""
    port, domain = free_port(), choose_domain({})
    page = ProcessGroup(PageProcess(cell, port).commands(), environment={"ROS_DOMAIN_ID": str(domain)})
    play = ["pack", "play", str(bag), "--clock", "--domain", str(domain), "--rate"]
    with (folder / "play.log").open("w") as log, page:
        wait_for_port(port)
        subprocess.run([*play, "20"], stdout=log, check=True)  # so that there is something to draw
        began = time.monotonic()
        with open_page(f"http://127.0.0.1:{port}") as browser:
            browser.wait_for_scene()
            first_picture = time.monotonic() - began
            with subprocess.Popen([*play, "1"], stdout=log) as player:
                seconds = [processor_time(page.pid("live"))]
                while player.poll() is None:
                    time.sleep(1.0)
                    seconds.append(processor_time(page.pid("live")))
    with AnyReader([bag]) as reader:
        mean = (seconds[-1] - seconds[0]) / (reader.duration * 1e-9)  # the player's start does not thin it
    return Cost(100.0 * median(np.diff(seconds)), 100.0 * mean, first_picture)
