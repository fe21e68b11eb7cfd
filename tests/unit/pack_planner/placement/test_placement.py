"""Algorithm 1: cheap where little has to move, refused where nothing fits, and repeatable."""

from collections.abc import Callable

import numpy as np
import pytest
from pydantic import ValidationError

from pack_core.errors import PackError
from pack_core.packing.cell import packing_cell
from pack_core.packing.free_space import footprint
from pack_core.packing.objects import Box
from pack_core.packing.scene import Scene
from pack_core.rotations import Pose
from pack_core.states import ObjectState, SceneState
from pack_planner.placement.approach import ApproachConfig
from pack_planner.placement.least_disturbance_planner import LeastDisturbancePlanner
from pack_planner.placement.placement_evaluation import PlacementConfig, PlacementEvaluation
from pack_planner.placement.placement_planner import (
    PLACEMENT_PLANNERS,
    PlacementPlannerConfig,
    PlacementPlanners,
)
from pack_planner.placement.placement_result import PlacementStatus, PlannedPlacement

StateOf = Callable[[Scene], SceneState]
QUICK = PlacementConfig(samples=60)


def plan(scene: Scene, state: SceneState, config: PlacementConfig = QUICK, seed: int = 0) -> PlannedPlacement:
    planner = LeastDisturbancePlanner(scene.description(), packing_cell(), config)
    return planner.plan(state, np.random.default_rng(seed))


def test_an_empty_container_costs_nothing_and_nothing_is_in_the_way(empty: Scene, state_of: StateOf) -> None:
    placement = plan(empty, state_of(empty))
    assert placement.status is PlacementStatus.SUCCESS
    assert placement.cost == pytest.approx(0.0, abs=1e-3)
    assert placement.collisions == ()
    assert placement.samples.is_feasible.all()


def test_the_placement_stands_upright_on_the_base(example: Scene, state_of: StateOf) -> None:
    placement = plan(example, state_of(example))
    assert placement.X_WO is not None
    assert placement.X_WO.p[2] == pytest.approx(example.new_object.half_extents[2], abs=0.005)


def test_without_rehearsals_the_cheapest_feasible_sample_is_chosen(example: Scene, state_of: StateOf) -> None:
    algorithm_1 = QUICK.model_copy(update={"approach": ApproachConfig(crowded=0.0, rounds=0)})
    placement = plan(example, state_of(example), algorithm_1)
    assert not placement.is_rehearsed
    assert placement.cost == placement.samples.costs[placement.samples.is_feasible].min()


@pytest.mark.parametrize("count", [1, 6, 100])
def test_the_samples_that_are_shown_go_from_the_cheapest_to_the_dearest(
    example: Scene, state_of: StateOf, count: int
) -> None:
    samples = plan(example, state_of(example), PlacementConfig(samples=20)).samples
    shown = samples.spread(count)
    assert len(shown) == min(count, 20)
    costs = [sample.cost for sample in shown]
    assert costs == sorted(costs)
    assert costs[0] == samples.costs.min()
    assert shown[0].rank == 0.0
    if count > 1:
        assert costs[-1] == samples.costs.max()
        assert shown[-1].rank == 1.0
    assert list(shown[0].poses) == [*example.names, example.new_object.name]


def test_a_blocked_scene_has_collisions_that_the_outlines_confirm(example: Scene, state_of: StateOf) -> None:
    placement = plan(example, state_of(example))
    assert placement.X_WO is not None
    outline = footprint(example.new_object, placement.X_WO)
    overlapped = {
        name
        for name, X_WO in example.poses().items()
        if outline.intersection(footprint(example.model_of(name), X_WO)).area > 1e-6
    }
    assert overlapped
    assert overlapped == set(placement.collisions)


def test_the_same_seed_gives_the_same_placement_on_any_number_of_threads(
    example: Scene, state_of: StateOf
) -> None:
    one, two = (
        plan(example, state_of(example), PlacementConfig(samples=60, threads=threads)) for threads in (1, 2)
    )
    assert np.array_equal(one.samples.settled, two.samples.settled)
    assert np.array_equal(one.samples.costs, two.samples.costs)
    assert one.X_WO is not None
    assert two.X_WO is not None
    assert np.array_equal(one.X_WO.p, two.X_WO.p)


def test_planning_again_with_one_planner_gives_the_same(example: Scene, state_of: StateOf) -> None:
    planner = LeastDisturbancePlanner(example, packing_cell(), QUICK)
    first, second = (planner.plan(state_of(example), np.random.default_rng(5)) for _ in range(2))
    assert np.array_equal(first.samples.costs, second.samples.costs)


def test_lifting_an_object_costs_ten_times_what_pushing_it_costs(example: Scene) -> None:
    evaluation = PlacementEvaluation(example, packing_cell(), QUICK)
    before = np.zeros((1, 2, 7))
    pushed, lifted = before.copy(), before.copy()
    pushed[0, 0, 0], lifted[0, 0, 2] = 0.02, 0.02
    assert evaluation.disturbance(before, pushed) == pytest.approx(0.02)
    assert evaluation.disturbance(before, lifted) == pytest.approx(0.2)


def test_a_place_on_top_of_an_object_costs_more_than_one_beside_it(empty: Scene, state_of: StateOf) -> None:
    block = Box(name="block", shape="box", size=(0.12, 0.20, 0.10), mass=5.0)
    scene = empty.model_copy(update={"objects": [block]}).with_poses(
        {"block": Pose(np.array([0.43, 0.0, 0.05]))}
    )
    samples = plan(scene, state_of(scene), PlacementConfig(samples=300)).samples
    beside = samples.sampled[:, 0] > 0.49 + 0.0325 * np.sqrt(2)
    on_top = np.linalg.norm(samples.sampled[:, :2] - [0.43, 0.0], axis=1) < 0.02
    assert np.any(on_top)
    assert samples.costs[on_top].min() > 100 * samples.costs[beside].max()


def test_a_full_container_has_no_feasible_placement_and_says_why(empty: Scene, state_of: StateOf) -> None:
    block = Box(name="block", shape="box", size=(0.264, 0.214, 0.10), mass=5.0)
    scene = empty.model_copy(update={"objects": [block]}).with_poses(
        {"block": Pose(np.array([0.5, 0.0, 0.05]))}
    )
    placement = plan(scene, state_of(scene))
    assert placement.status is PlacementStatus.NO_FEASIBLE_PLACEMENT
    assert placement.X_WO is None
    assert placement.reason.startswith("none of 60 samples: ")
    assert "overlap" in placement.reason


def test_places_tried_before_are_left_out(example: Scene, state_of: StateOf) -> None:
    few_rounds = QUICK.model_copy(update={"approach": ApproachConfig(rounds=2)})
    planner = LeastDisturbancePlanner(example, packing_cell(), few_rounds)
    tried: list[np.ndarray] = []
    for _ in range(3):
        placement = planner.plan(state_of(example), np.random.default_rng(0), avoid=tried, avoid_radius=0.03)
        assert placement.X_WO is not None
        assert all(np.linalg.norm(placement.X_WO.p[:2] - p[:2]) >= 0.03 for p in tried)
        tried.append(placement.X_WO.p)


def test_planning_leaves_the_state_untouched(example: Scene, state_of: StateOf) -> None:
    state = state_of(example)
    before = {name: (X_WO.p.copy(), X_WO.q.copy()) for name, X_WO in state.poses().items()}
    plan(example, state)
    for name, X_WO in state.poses().items():
        assert np.array_equal(X_WO.p, before[name][0])
        assert np.array_equal(X_WO.q, before[name][1])


def test_missing_and_unknown_objects_are_named(example: Scene, state_of: StateOf) -> None:
    objects = dict(state_of(example).objects)
    fewer = {name: state for name, state in objects.items() if name != "tea_box"}
    with pytest.raises(PackError, match=r"lacks \['tea_box'\]"):
        plan(example, SceneState(0.0, fewer))
    with pytest.raises(PackError, match=r"unknown \['spoon'\].*soup_can"):
        plan(example, SceneState(0.0, objects | {"spoon": ObjectState(Pose(np.zeros(3)))}))


def test_a_new_object_too_large_for_the_container_is_refused(example: Scene) -> None:
    giant = example.new_object.model_copy(update={"size": (0.3, 0.3, 0.1)})
    with pytest.raises(PackError, match="fits between the walls"):
        LeastDisturbancePlanner(example.model_copy(update={"new_object": giant}), packing_cell(), QUICK)


def test_unknown_variants_are_refused_with_the_known_ones(example: Scene) -> None:
    with pytest.raises(PackError, match=f"'magic'; allowed: {', '.join(PLACEMENT_PLANNERS)}"):
        PlacementPlanners(example, packing_cell(), PlacementPlannerConfig()).of("magic")
    with pytest.raises(ValidationError, match=r"physics, algorithm_1, algorithm_1_literal, random.*'magic'"):
        PlacementPlannerConfig(variant="magic")


def test_the_configured_planner_plans_unless_a_request_names_another(example: Scene) -> None:
    planners = PlacementPlanners(example, packing_cell(), PlacementPlannerConfig(variant="random"))
    assert isinstance(planners.of(), PLACEMENT_PLANNERS["random"])
    assert isinstance(planners.of("physics"), LeastDisturbancePlanner)
    assert planners.of() is planners.of("random")


@pytest.mark.parametrize("variant", PLACEMENT_PLANNERS)
def test_every_registered_planner_repeats_its_placement(
    variant: str, example: Scene, state_of: StateOf
) -> None:
    config = PlacementPlannerConfig(variant=variant, samples=60)
    planner = PlacementPlanners(example, packing_cell(), config).of()
    one, two = (planner.plan(state_of(example), np.random.default_rng(3), lean=0.3) for _ in range(2))
    assert one.status is PlacementStatus.SUCCESS
    assert one.X_WO is not None
    assert two.X_WO is not None
    assert np.array_equal(one.X_WO.p, two.X_WO.p)
