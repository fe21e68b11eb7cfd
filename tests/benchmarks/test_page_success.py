"""Runs of live cells with the page open, beside the same runs without it.

`pytest -m benchmark -s tests/benchmarks/test_page_success.py` prints a line for each run and a sum for each
cell. In the place of the browser stands a client that takes every message of the page and draws nothing:
drawing in software takes a core that the cell needs, and that a graphics card would have spared.
"""

from __future__ import annotations

import subprocess
import sys
from dataclasses import asdict
from pathlib import Path
from typing import Any

import pytest
import viser
from pytest_benchmark.fixture import BenchmarkFixture
from websockets.sync.client import connect

from benchmarks.ports import free_port, wait_for_port
from pack_core.cells import cell_part
from pack_core.paths import project_root

pytestmark = pytest.mark.benchmark
ORDER = str(project_root() / "config" / "orders" / "order_03.json")
RUNS = {
    "packing": [["--seed", str(seed)] for seed in range(10)],
    "palletizing": [["--order", ORDER]],
    "blocks": [["--blocks", "2", "--seed", str(seed)] for seed in range(1)],
}
"""What `pack demo` is told."""
MEASURES = {
    "packing": ("success", "execution_time", "real_time_factor", "iteration_ms", "very_late"),
    "palletizing": ("is_complete", "interruptions", "duration_s"),
    "blocks": ("success", "failed_grasps", "disturbances", "duration_s"),
}
"""What is printed of a run; the first is whether it succeeded."""
MUCH = 100_000
"""The page without a scene is less [bytes]."""


@pytest.mark.timeout(3600)
@pytest.mark.parametrize("cell", RUNS)
def test_the_page_takes_nothing_from_a_run(benchmark: BenchmarkFixture, cell: str, tmp_path: Path) -> None:
    succeeded = benchmark.pedantic(lambda: successes(cell, tmp_path), rounds=1)
    sys.stdout.write(f"\n{cell}: succeeded of {len(RUNS[cell])}: {succeeded}\n")
    assert succeeded["page"] >= succeeded["no page"]


def successes(cell: str, folder: Path) -> dict[str, int]:
    """How many runs succeed without and with the page, one after the other by turns."""
    succeeded = {"no page": 0, "page": 0}
    for number, options in enumerate(RUNS[cell]):
        for how, run in (("no page", run_alone), ("page", run_shown)):
            output = folder / f"{cell}_{number}_{how.replace(' ', '_')}"
            command = ["pack", "demo", cell, *options, "--no-video", "-o", str(output)]
            run(command, folder / "demo.log")
            shown = {name: measures_of(cell, output)[name] for name in MEASURES[cell]}
            succeeded[how] += shown[MEASURES[cell][0]]
            sys.stdout.write(f"\n{cell:12}{' '.join(options[-1:]):3}{how:8}{shown}")
            sys.stdout.flush()
    return succeeded


def run_alone(command: list[str], log: Path) -> None:
    """A run without the page; one that fails is counted by its measures."""
    with log.open("w") as output:
        subprocess.run(command, stdout=output, check=False)


def run_shown(command: list[str], log: Path) -> None:
    """A run whose page has a client from the page's start to the run's end."""
    port = free_port()
    with log.open("w") as output:
        demo = subprocess.Popen([*command, "--live", "--port", str(port)], stdout=output)
        wait_for_port(port)
        version = f"viser-v{viser.__version__}"
        with connect(f"ws://127.0.0.1:{port}", subprotocols=[version], max_size=None) as page:
            received = sum(len(message) for message in page)  # until the page closes
        demo.wait()
    assert received > MUCH, "the page has sent next to nothing"


def measures_of(cell: str, folder: Path) -> dict[str, Any]:
    """The measures of a recorded run."""
    evaluator = cell_part(cell, "evaluator")
    return asdict(evaluator.measure(evaluator.load(folder)))
