"""Algorithm 1 alone does no more than the paper says of it."""

import numpy as np

from pack_core.packing.cell import packing_cell
from pack_core.packing.scene_file import load_scene
from pack_core.paths import config_path
from pack_core.rotations import Pose
from pack_core.states import ObjectState, SceneState
from pack_planner.placement.approach import ApproachConfig
from pack_planner.placement.least_disturbance_planner import Algorithm1Planner
from pack_planner.placement.placement_evaluation import PlacementConfig

EXAMPLE = load_scene(config_path("scenarios", "packing", "example.yaml"))
HELD = Pose(np.array([0.5, 0.0, 0.5]))
POSES = EXAMPLE.poses() | {EXAMPLE.new_object.name: HELD}
STATE = SceneState(0.0, {name: ObjectState(X_WO) for name, X_WO in POSES.items()})
QUICK = PlacementConfig(samples=60)


def test_algorithm_1_alone_takes_the_cheapest_feasible_sample_and_leans_to_no_side() -> None:
    crowded = QUICK.model_copy(update={"approach": ApproachConfig(crowded=0.0)})
    planner = Algorithm1Planner(EXAMPLE.description(), packing_cell(), crowded)
    placement = planner.plan(STATE, np.random.default_rng(0), lean=0.6)
    assert placement.cost == placement.samples.costs[placement.samples.is_feasible].min()
    assert placement.collisions
    assert not placement.is_rehearsed
    np.testing.assert_array_equal(placement.way.over, 0.0)
