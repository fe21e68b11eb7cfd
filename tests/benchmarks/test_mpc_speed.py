"""Wall time of an MPC iteration: both optimizers, threads, and growth with the number of objects."""

from __future__ import annotations

import numpy as np
import pytest
from pytest_benchmark.fixture import BenchmarkFixture

from pack_core.packing.cell import PackingCell, packing_cell
from pack_core.packing.goals import PackingMethod
from pack_lockstep.packing.lockstep import Lockstep, Step
from pack_lockstep.packing.lockstep_config import LockstepConfig, lockstep_config
from pack_sim.packing.scene_generator import generate_scene

pytestmark = pytest.mark.benchmark
SEED = 1000


@pytest.mark.parametrize("optimizer", ["sgn", "ilqr"])
def test_a_second_thread_shortens_an_iteration(benchmark: BenchmarkFixture, optimizer: str) -> None:
    medians = timed(benchmark, {f"{n} threads": (packing_cell(), config_with(optimizer, n)) for n in (1, 2)})
    assert medians[1] < 0.9 * medians[0]


def test_an_iteration_grows_less_than_the_number_of_objects(benchmark: BenchmarkFixture) -> None:
    config = config_with("sgn", 2)
    medians = timed(benchmark, {f"{n} objects": (cell_with(n), config) for n in (1, 5, 10, 20)})
    assert medians[-1] < 20 * medians[0]


def timed(benchmark: BenchmarkFixture, cases: dict[str, tuple[PackingCell, LockstepConfig]]) -> list[float]:
    """Median iteration times [ms] of the cases, one after the other; the benchmark's file keeps them."""
    rows = benchmark.pedantic(lambda: [iteration_times(*case) for case in cases.values()], rounds=1)
    for name, times in zip(cases, rows, strict=True):
        median, p95 = np.percentile(times, [50, 95])
        benchmark.extra_info[name] = {"median_ms": round(median, 1), "p95_ms": round(p95, 1)}
    return [float(np.median(times)) for times in rows]


def iteration_times(cell: PackingCell, config: LockstepConfig) -> list[float]:
    """Wall times [ms] of a run's iterations above and among the objects, in INSERT and FINE-TUNE."""
    scene = generate_scene(SEED, cell, blocked=False)
    times: list[float] = []

    def note(step: Step) -> None:
        if step.plan is not None and step.stage != "PRE_PACK":
            times.append(step.plan.iteration_ms)

    Lockstep(cell, scene, config, PackingMethod.PACK_IT_IN, SEED).run(note)
    return times


def config_with(optimizer: str, threads: int) -> LockstepConfig:
    """The nodes' configuration with this optimizer."""
    config = lockstep_config()
    controller = config.session.controller.model_copy(update={"optimizer": optimizer, "threads": threads})
    session = config.session.model_copy(update={"controller": controller})
    return config.model_copy(update={"session": session})


def cell_with(objects: int) -> PackingCell:
    """The packing cell with its objects repeated; the container grows with them beyond five."""
    cell = packing_cell()
    own = cell.scene.objects
    items = [own[i % len(own)].model_copy(update={"name": f"object_{i}"}) for i in range(objects)]
    scale = max(1.0, np.sqrt(objects / len(own)))
    container = cell.scene.container
    wide = container.model_copy(update={"size": tuple(scale * side for side in container.size)})
    scene = cell.scene.model_copy(update={"objects": items, "container": wide})
    return cell.model_copy(update={"scene": scene})
