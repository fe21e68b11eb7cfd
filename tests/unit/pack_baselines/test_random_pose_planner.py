"""The placement planner of the paper's baseline does no more than its section of the paper says."""

import numpy as np

from pack_baselines.random_pose_planner import RandomPosePlanner
from pack_core.packing.cell import packing_cell
from pack_core.packing.scene_file import load_scene
from pack_core.paths import config_path
from pack_core.rotations import Pose
from pack_core.states import ObjectState, SceneState
from pack_planner.placement.least_disturbance_planner import LeastDisturbancePlanner
from pack_planner.placement.placement_evaluation import PlacementConfig
from pack_planner.placement.placement_result import PlacementStatus

EXAMPLE = load_scene(config_path("scenarios", "packing", "example.yaml"))
HELD = Pose(np.array([0.5, 0.0, 0.5]))
POSES = EXAMPLE.poses() | {EXAMPLE.new_object.name: HELD}
STATE = SceneState(0.0, {name: ObjectState(X_WO) for name, X_WO in POSES.items()})
QUICK = PlacementConfig(samples=60)


def test_the_random_variant_takes_any_pose_with_its_collisions() -> None:
    planner = RandomPosePlanner(EXAMPLE, packing_cell(), QUICK)
    placements = [planner.plan(STATE, np.random.default_rng(seed)) for seed in range(8)]
    assert all(placement.status is PlacementStatus.SUCCESS for placement in placements)
    assert all(placement.collisions for placement in placements)
    places = np.array([placement.X_WO.p[:2] for placement in placements if placement.X_WO is not None])
    assert np.ptp(places, axis=0).min() > 0.05
    planned = LeastDisturbancePlanner(EXAMPLE.description(), packing_cell(), QUICK)
    best = planned.plan(STATE, np.random.default_rng(0))
    assert max(p.cost for p in placements) > 2 * best.cost
