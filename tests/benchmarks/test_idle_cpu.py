"""Processor time of each node of a cell that runs in real time and has no goal.

`pytest -m benchmark -s tests/benchmarks/test_idle_cpu.py` prints a table for each cell.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

import pytest
from pytest_benchmark.fixture import BenchmarkFixture

from benchmarks.processor_time import processor_time
from pack_bringup.graph.graph import load_graph
from pack_bringup.graph.processes import ProcessGroup
from pack_bringup.graph.running import choose_domain

pytestmark = pytest.mark.benchmark
START = 30.0
"""Wall clock in which all nodes have come up, imported and compiled what they need [s]."""
DURATION = 15.0
"""Wall clock over which processor time is counted [s]."""
BOUNDS = {"packing": 80.0, "palletizing": 120.0, "blocks": 120.0}
"""Of all nodes of a cell together [% of a core]."""


@pytest.mark.parametrize(("cell", "bound"), BOUNDS.items())
def test_a_cell_without_a_goal_leaves_most_of_two_cores_to_its_controller(
    benchmark: BenchmarkFixture, cell: str, bound: float, tmp_path: Path
) -> None:
    shares = benchmark.pedantic(lambda: idle_shares(cell, 1.0, tmp_path), rounds=1)
    shares["sum"] = sum(shares.values())
    benchmark.extra_info |= {name: round(share, 1) for name, share in shares.items()}
    sys.stdout.write(
        "\n" + "\n".join(f"{name:14}{share:6.1f} % of a core" for name, share in shares.items()) + "\n"
    )
    assert shares["sum"] < bound


def idle_shares(cell: str, factor: float, folder: Path) -> dict[str, float]:
    """Processor time of a cell's nodes, by name [% of a core]."""
    overrides = {"sim": {"real_time_factor": str(factor)}, "recorder": {"path": f'"{folder / "run"}"'}}
    commands = load_graph(cell).commands(overrides)
    environment = {"ROS_DOMAIN_ID": str(choose_domain({}))}
    with (
        (folder / "nodes.log").open("w") as log,
        ProcessGroup(commands, environment=environment, output=log) as group,
    ):
        time.sleep(START)
        before, began = {name: processor_time(group.pid(name)) for name in commands}, time.monotonic()
        time.sleep(DURATION)
        duration = time.monotonic() - began
        assert not group.exit_codes, (folder / "nodes.log").read_text()
        return {
            name: 100.0 * (processor_time(group.pid(name)) - before[name]) / duration for name in commands
        }
