"""Trials of every cell on a local Ray cluster are those of processes, bit for bit; skipped without Ray."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import pytest

from pack_core.blocks.cell import blocks_cell
from pack_core.cells import CELLS
from pack_core.paths import config_path
from pack_lockstep.benchmarking.benchmark import Benchmark, run_benchmark
from pack_lockstep.benchmarking.pools import Pool, open_pool
from pack_lockstep.benchmarking.results_folder import ResultsFolder
from pack_lockstep.blocks.benchmark import BlocksBenchmark, BlocksSetup, PlanJob
from pack_lockstep.blocks.benchmark_instances import FileInstance
from pack_lockstep.blocks.settings import lockstep_config
from pack_lockstep.packing import settings as packing
from pack_lockstep.packing.benchmark import PackingBenchmark
from pack_lockstep.palletizing import settings as palletizing
from pack_lockstep.palletizing.benchmark import OrderJob, PalletBenchmark

ray = pytest.importorskip("ray", reason="Ray is an extra: requirements/cluster.txt")
pytestmark = pytest.mark.timeout(600)

WALL_CLOCK = {"iteration_ms", "wall_time_s", "first_plan_ms", "total_ms"}


def benchmarks() -> dict[str, Benchmark[Any, Any]]:
    """A short benchmark of every cell."""
    setup = packing.set_up(packing.BenchmarkSettings(), threads=1)
    order = OrderJob(config_path("orders", "order_03.json"), 0)
    # Gains that the driver refuses at once, so that an order takes no time.
    orders = palletizing.set_up(motion="table_4_1", vision=False)
    instance = FileInstance.read(config_path("scenarios", "blocks", "example.yaml"), 0)
    return {
        "packing": PackingBenchmark(setup, (packing.SceneJob("seed_3", 3),)),
        "palletizing": PalletBenchmark(orders, (order,)),
        "blocks": BlocksBenchmark(
            BlocksSetup(blocks_cell(), lockstep_config(), 5.0, False), (PlanJob("beam", instance),)
        ),
    }


@pytest.fixture(scope="module")
def cluster() -> Iterator[Pool]:
    with open_pool(1, "local", 1) as pool:
        yield pool


def trials(benchmark: Benchmark[Any, Any], folder: Path, pool: Pool) -> list[Mapping[str, Any]]:
    """The kept trials, without what was measured on the wall clock."""
    results = ResultsFolder(folder)
    list(run_benchmark(benchmark, results, pool, {}))
    return [
        {key: value for key, value in trial.items() if key not in WALL_CLOCK}
        for trial in results.kept().trials
    ]


@pytest.mark.parametrize("cell", CELLS)
def test_a_cluster_gives_what_processes_give(cluster: Pool, tmp_path: Path, cell: str) -> None:
    benchmark = benchmarks()[cell]
    on_cluster = trials(benchmark, tmp_path / "cluster", cluster)
    with open_pool(1, None, 1) as processes:
        assert trials(benchmark, tmp_path / "processes", processes) == on_cluster
    assert len(on_cluster) == len(benchmark.jobs)
