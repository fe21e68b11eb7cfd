"""How long a placement and a blocked scene take."""

import itertools

import numpy as np
import pytest
from pytest_benchmark.fixture import BenchmarkFixture

from pack_core.cells.packing import packing_cell
from pack_core.paths import config_path
from pack_core.rotations import Pose
from pack_core.scene.scene_file import load_scene
from pack_core.scene.state import ObjectState, SceneState
from pack_planner.placement.placement_planner import PlacementConfig, PlacementPlanner
from pack_sim.packing.scene_generator import generate_scene

pytestmark = pytest.mark.benchmark


def test_placement_takes_at_most_300_ms(benchmark: BenchmarkFixture) -> None:
    scene = load_scene(config_path("scenarios", "example.yaml"))
    poses = scene.poses() | {scene.new_object.name: Pose(np.array([0.5, 0.0, 0.5]))}
    state = SceneState(0.0, {name: ObjectState(X_WO) for name, X_WO in poses.items()})
    planner = PlacementPlanner(scene, packing_cell(), PlacementConfig())
    benchmark.pedantic(lambda: planner.plan(state, np.random.default_rng(0)), rounds=10, warmup_rounds=1)
    assert benchmark.stats.stats.median < 0.3


def test_a_blocked_scene_takes_at_most_2_s(benchmark: BenchmarkFixture) -> None:
    seeds = itertools.count(100)
    benchmark.pedantic(lambda: generate_scene(next(seeds), packing_cell()), rounds=10)
    assert benchmark.stats.stats.mean < 2.0
