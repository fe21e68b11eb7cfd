"""Problems that contradict themselves are refused, with the ids concerned."""

import math

import pytest

from pack_core.blocks.plan import PlanStatus
from pack_core.blocks.planar import PlanarPose
from pack_core.blocks.problem import BlockSize, PlacedBlock, Problem
from pack_planner.rearrangement.instances import square_workspace
from pack_planner.rearrangement.planning import plan

STARTS = {"a": (-100, 0), "b": (100, 0)}
GOALS = {"a": (-100, 150), "b": (100, 150)}


def refusal(problem: Problem) -> tuple[str, tuple[str, ...]]:
    made = plan(problem)
    assert made.status is PlanStatus.INVALID_INPUT
    assert not made.actions
    return made.diagnosis.text, made.diagnosis.blocks


def test_goals_that_overlap_are_named(make) -> None:
    text, blocks = refusal(make(STARTS, {"a": (0, 0), "b": (51, 0)}))
    assert blocks == ("a", "b")
    assert "1.0 mm apart" in text


def test_goals_two_millimetres_apart_are_fine(make) -> None:
    assert plan(make(STARTS, {"a": (0, 0), "b": (52.8, 0)})).is_solved


def test_starts_that_overlap_are_named_but_measured_ones_may_touch(make) -> None:
    text, blocks = refusal(make({"a": (0, 0), "b": (48, 0)}, GOALS))
    assert blocks == ("a", "b")
    assert "measure them again" in text
    assert plan(make({"a": (0, 0), "b": (50.3, 0)}, GOALS)).is_solved


def test_a_goal_outside_the_workspace_is_named_with_its_corner(make) -> None:
    text, blocks = refusal(make(STARTS, GOALS | {"b": (290, 0)}))
    assert blocks == ("b",)
    assert "its corner (0.3154" in text
    assert "by 15.4 mm" in text


def test_a_start_outside_the_workspace_is_refused_unless_that_is_allowed(make) -> None:
    starts = STARTS | {"b": (290, 0)}
    assert refusal(make(starts, GOALS))[1] == ("b",)
    assert plan(make(starts, GOALS, starts_may_be_outside=True)).is_solved


def test_ids_must_be_unique_and_goals_have_blocks(make) -> None:
    pose, far = PlanarPose(0.0, 0.0), PlanarPose(0.1, 0.1)
    twice = Problem((PlacedBlock("a", pose), PlacedBlock("a", far)), {"a": pose}, square_workspace(0.6))
    assert refusal(twice) == ("block ids occur more than once: a", ("a",))
    assert refusal(make({"a": (0, 0)}, GOALS)) == ("goals of blocks that are not there: b", ("b",))


def test_an_obstacle_on_a_goal_is_named(make) -> None:
    assert refusal(make({"a": (-150, 0), "tag 7": (20, 10, 0.3)}, {"a": (0, 0)})) == (
        "tag 7 stands on the goal of a: take it away",
        ("a", "tag 7"),
    )


def test_a_planner_that_knows_no_obstacles_is_not_asked_for_a_way_around_one(make) -> None:
    made = plan(make({"a": (-150, 0), "tag 7": (100, 100)}, {"a": (0, 0)}), method="pirs")
    assert made.status is PlanStatus.INVALID_INPUT
    assert "tag 7 in the way" in made.diagnosis.text


@pytest.mark.parametrize("broken", [math.nan, math.inf])
def test_poses_that_are_not_finite_are_named(make, broken: float) -> None:
    text, blocks = refusal(make(STARTS | {"b": (broken, 0)}, GOALS))
    assert blocks == ("b",)
    assert "start of b is not finite" in text


def test_blocks_too_wide_for_the_gripper_are_refused(make) -> None:
    wide = BlockSize(0.0775, 0.0775, 0.05)
    text, _ = refusal(make(STARTS, GOALS, sizes=dict.fromkeys(STARTS, wide)))
    assert "need an opening of 85.5 mm; the gripper opens 85.0 mm" in text


@pytest.mark.parametrize(
    "corners",
    [((0, 0), (1, 0)), ((0, 0), (1, 0), (0.2, 0.2), (0, 1)), ((0, 0), (0, 0), (1, 0), (1, 1))],
)
def test_a_workspace_that_is_no_convex_polygon_is_refused(corners: tuple[tuple[float, float], ...]) -> None:
    problem = Problem((PlacedBlock("a", PlanarPose(0.3, 0.3)),), {"a": PlanarPose(0.1, 0.1)}, corners)
    assert "no convex polygon" in refusal(problem)[0]


def test_corners_may_run_either_way_round(make) -> None:
    problem = make(STARTS, GOALS)
    turned = Problem(problem.blocks, problem.goals, problem.workspace[::-1])
    assert plan(turned).is_solved


def test_more_blocks_than_a_method_takes_are_refused(make) -> None:
    rows = {f"b{i}": (60 * (i % 7), 60 * (i // 7)) for i in range(33)}
    assert "33 blocks; allowed: up to 31 with beam" in refusal(make(rows, size=2.0))[0]


def test_symmetry_is_one_two_or_four(make) -> None:
    assert "allowed: 1, 2, 4" in refusal(make(STARTS, GOALS, symmetry=3))[0]


@pytest.mark.parametrize(
    ("size", "fields", "part"),
    [
        (BlockSize(0.04, 0.0, 0.05), {}, "above 0"),
        (BlockSize(0.04, math.nan, 0.05), {}, "above 0"),
        (BlockSize(0.04, 0.05, 0.02), {}, "20.0 mm high"),
        (BlockSize(0.04, 0.05, 0.05), {"symmetry": 4}, "longer than wide"),
        (BlockSize(0.08, 0.09, 0.05), {}, "need an opening of 88.0 mm"),
    ],
)
def test_a_size_that_no_gripper_handles_is_refused(make, size: BlockSize, fields: dict, part: str) -> None:
    text, blocks = refusal(make({"a": (0, 0)}, {"a": (100, 0)}, sizes={"a": size}, **fields))
    assert part in text
    assert blocks == ("a",)


def test_a_block_that_fits_the_gripper_one_way_only_is_grasped_that_way(make) -> None:
    made = plan(make({"a": (0, 0)}, {"a": (100, 100)}, sizes={"a": BlockSize(0.1, 0.05, 0.05)}))
    assert [action.grasp for action in made.actions] == [1]
