"""How long a placement and a blocked scene take."""

import itertools
import time
from collections.abc import Callable

import numpy as np
import pytest
from pytest_benchmark.fixture import BenchmarkFixture

from pack_core.packing.cell import packing_cell
from pack_core.packing.scene_file import load_scene
from pack_core.paths import config_path
from pack_core.rotations import Pose
from pack_core.states import ObjectState, SceneState
from pack_lockstep.packing.lockstep_config import LockstepConfig
from pack_planner.placement.approach import ApproachConfig
from pack_planner.placement.least_disturbance_planner import LeastDisturbancePlanner
from pack_planner.placement.placement_evaluation import PlacementConfig
from pack_planner.placement.placement_result import PlannedPlacement
from pack_sim.packing.scene_generator import generate_scene

pytestmark = pytest.mark.benchmark


def planning(crowded: float) -> Callable[[], PlannedPlacement]:
    """Plans in the example scene; with `crowded` 0 after rehearsals."""
    scene = load_scene(config_path("scenarios", "packing", "example.yaml"))
    poses = scene.poses() | {scene.new_object.name: Pose(np.array([0.5, 0.0, 0.5]))}
    state = SceneState(0.0, {name: ObjectState(X_WO) for name, X_WO in poses.items()})
    config = PlacementConfig(approach=ApproachConfig(crowded=crowded))
    planner = LeastDisturbancePlanner(scene, packing_cell(), config)
    return lambda: planner.plan(state, np.random.default_rng(0), lean=0.6)


def seconds(run: Callable[[], object]) -> float:
    """How long a call takes [s of wall clock]."""
    started = time.perf_counter()
    run()
    return time.perf_counter() - started


def test_a_placement_takes_no_longer_than_lockstep_says(benchmark: BenchmarkFixture) -> None:
    benchmark.pedantic(planning(crowded=1.0), rounds=10, warmup_rounds=1)
    assert benchmark.stats.stats.median < LockstepConfig().placement_latency


def test_rehearsals_take_no_longer_beside_a_placement_than_lockstep_says() -> None:
    plain, rehearsed, config = planning(crowded=1.0), planning(crowded=0.0), LockstepConfig()
    count = rehearsed().rehearsals
    assert count > 0
    # In turn, so that both meet the machine in the same state.
    times = np.array([(seconds(plain), seconds(rehearsed)) for _ in range(10)])
    plain_s, rehearsed_s = np.median(times, axis=0)
    ratio = rehearsed_s / plain_s - 1.0
    assert ratio < count * config.rehearsal_latency / config.placement_latency


def test_a_blocked_scene_takes_at_most_2_s(benchmark: BenchmarkFixture) -> None:
    seeds = itertools.count(100)
    benchmark.pedantic(lambda: generate_scene(next(seeds), packing_cell()), rounds=10)
    assert benchmark.stats.stats.mean < 2.0
