"""Algorithm 1 as printed, held against its lines."""

import numpy as np
import pytest

from pack_baselines.literal_planner import LiteralPlanner
from pack_core.packing.cell import packing_cell
from pack_core.packing.entry import plan_entry
from pack_core.packing.scene_file import load_scene
from pack_core.paths import config_path
from pack_core.rotations import Pose
from pack_core.states import ObjectState, SceneState
from pack_planner.placement.placement_evaluation import PlacementConfig, PlacementEvaluation
from pack_planner.placement.placement_result import PlannedPlacement

EXAMPLE = load_scene(config_path("scenarios", "packing", "example.yaml"))
HELD = Pose(np.array([0.5, 0.0, 0.5]))
POSES = EXAMPLE.poses() | {EXAMPLE.new_object.name: HELD}
STATE = SceneState(0.0, {name: ObjectState(X_WO) for name, X_WO in POSES.items()})
QUICK = PlacementConfig(samples=60)


@pytest.fixture(scope="module")
def planned() -> PlannedPlacement:
    planner = LiteralPlanner(EXAMPLE.description(), packing_cell(), QUICK)
    return planner.plan(STATE, np.random.default_rng(0), lean=0.6)


@pytest.fixture(scope="module")
def best(planned: PlannedPlacement) -> int:
    return int(np.argmin(planned.samples.costs))


def test_the_packing_pose_is_the_settled_one_of_the_cheapest_sample_of_all(
    planned: PlannedPlacement, best: int
) -> None:
    assert planned.X_WO is not None
    X_WO = [*planned.X_WO.p, *planned.X_WO.q]
    np.testing.assert_allclose(X_WO, planned.samples.settled[best], rtol=1e-12)
    assert planned.cost == planned.samples.costs.min()


def test_costs_are_equation_6_over_the_objects_in_the_container(planned: PlannedPlacement, best: int) -> None:
    evaluation = PlacementEvaluation(EXAMPLE.description(), packing_cell(), QUICK)
    names, scene = planned.samples.names, planned.samples.scenes[best]
    moved = sum(
        np.linalg.norm(np.array(QUICK.weights) * (x[:3] - POSES[name].p))
        for name, x in zip(names[:-1], scene, strict=False)
    )
    K = evaluation.penetration(evaluation.at_rest(scene), resting=0.0)
    assert K > 0.0  # objects that stand sink in a little
    assert planned.cost == pytest.approx(moved + QUICK.beta * K)


def test_the_collision_list_has_what_the_sampled_pose_overlaps_in_the_settled_scene(
    planned: PlannedPlacement, best: int
) -> None:
    evaluation = PlacementEvaluation(EXAMPLE.description(), packing_cell(), QUICK)
    settled, sampled = planned.samples.scenes[best], planned.samples.sampled[best]
    there = evaluation.candidate(evaluation.at_rest(settled), sampled, 0.0)
    assert planned.collisions == there.collisions


def test_in_an_empty_container_it_costs_nothing_to_be_in_nobodys_way() -> None:
    empty = EXAMPLE.model_copy(update={"objects": []})
    state = SceneState(0.0, {EXAMPLE.new_object.name: ObjectState(HELD)})
    planner = LiteralPlanner(empty.description(), packing_cell(), PlacementConfig(samples=5))
    planned = planner.plan(state, np.random.default_rng(0))
    assert planned.X_WO is not None
    assert planned.collisions == ()
    assert np.isfinite(planned.samples.costs).all()


def test_the_way_in_is_straight_down_onto_the_packing_pose(planned: PlannedPlacement) -> None:
    assert planned.X_WO is not None
    # also where that is right beside a wall
    corner = Pose(np.array([*EXAMPLE.container.lower + 0.033, planned.X_WO.p[2]]))
    for X_WN in (planned.X_WO, corner):
        entry = plan_entry(EXAMPLE, X_WN, planned.collisions, POSES, planned.way)
        axis, aside = entry.at(np.linspace(0.0, 0.3, 7))
        np.testing.assert_array_equal(axis, 0.0)
        np.testing.assert_array_equal(aside, 0.0)
