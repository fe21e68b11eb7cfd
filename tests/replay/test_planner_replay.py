import numpy as np

from pack_bringup.node_parameters import load_parameters
from pack_core.cells.packing import packing_cell
from pack_core.ros.contracts import packing as contracts
from pack_core.ros.conversions import from_scene
from pack_planner.placement.placement_planner import PlacementConfig, PlacementPlanner
from replay.sample import COUNTS, SEED, sample, sample_run, sample_scene


def test_the_core_chooses_the_placement_that_the_node_chose() -> None:
    """The request is one of the scenes just before the goal's first plan; which one is not recorded."""
    assert sample().counts()["/scene"] == COUNTS["/scene"]
    run = sample_run()
    scenes = [from_scene(message) for message in sample().of(contracts.SCENE.name)]
    candidates = [scene for scene in scenes if run.start - 0.05 <= scene.time <= run.start + 0.05]
    assert candidates
    config = load_parameters("planner", PlacementConfig)
    planner = PlacementPlanner(sample_scene(), packing_cell(), config)
    chosen = [planner.plan(scene, np.random.default_rng(SEED)) for scene in candidates]
    p_WT = run.iterations.p_WT[0]
    distances = [np.inf if item.X_WO is None else np.linalg.norm(item.X_WO.p - p_WT) for item in chosen]
    best = int(np.argmin(distances))
    assert distances[best] < 1e-9
    assert chosen[best].collisions == run.iterations.collisions[0]
