"""The verifier sees what is wrong with a plan."""

from dataclasses import replace

import pytest

from pack_core.blocks.plan import PickPlace, Plan, PlanStatus, Push
from pack_core.blocks.planar import PlanarPose
from pack_core.blocks.problem import Problem
from pack_evaluation.blocks.plan_verifier import verify
from unit.problems import make_problem

HERE, THERE = PlanarPose(-0.1, 0.0), PlanarPose(0.1, 0.0)


@pytest.fixture
def problem() -> Problem:
    """Block a goes to the right, b stays 30 mm beside the goal, c far off."""
    others = {"b": (100, 81), "c": (-250, -250)}
    return make_problem({"a": (-100, 0), **others}, {"a": (100, 0), **others})


def plan_of(*actions: PickPlace | Push) -> Plan:
    return Plan(PlanStatus.FEASIBLE, actions)


def faults(problem: Problem, *actions: PickPlace | Push) -> str:
    return "; ".join(verify(problem, plan_of(*actions)))


def test_a_good_plan_has_no_faults(problem: Problem) -> None:
    assert verify(problem, plan_of(PickPlace("a", HERE, THERE, grasp=0))) == []
    middle = replace(THERE, x=0.0)
    assert verify(problem, plan_of(PickPlace("a", HERE, middle, grasp=0), Push("a", middle, THERE))) == []


def test_an_empty_plan_leaves_the_block_away_from_its_goal(problem: Problem) -> None:
    assert faults(problem) == "a does not end at its goal"


def test_fingers_that_hit_a_neighbour_are_seen() -> None:
    problem = make_problem({"a": (-100, 0), "b": (100, 70)}, {"a": (100, 0), "b": (100, 70)})
    assert verify(problem, plan_of(PickPlace("a", HERE, THERE, grasp=0))) == []
    assert "gripper at the place hits b" in faults(problem, PickPlace("a", HERE, THERE, grasp=1))


def test_a_block_put_into_another_is_seen(problem: Problem) -> None:
    onto = PlanarPose(0.1, 0.06)
    assert "block put down hits b" in faults(problem, PickPlace("a", HERE, onto, grasp=0))


def test_a_push_over_another_block_is_seen() -> None:
    problem = make_problem({"a": (-50, 0), "b": (20, 30)}, {"a": (60, 0), "b": (20, 30)})
    text = faults(problem, Push("a", PlanarPose(-0.05, 0.0), PlanarPose(0.06, 0.0)))
    assert "block pushed hits b" in text


def test_a_gripper_without_room_behind_the_block_is_seen() -> None:
    problem = make_problem({"a": (0, 0), "b": (-60, 0)}, {"a": (60, 0), "b": (-60, 0)})
    text = faults(problem, Push("a", PlanarPose(0.0, 0.0), PlanarPose(0.06, 0.0)))
    assert text == "action 1 (Push a): the gripper pushing hits b"


@pytest.mark.parametrize(
    ("end", "fault"),
    [
        (PlanarPose(-0.04, 0.03), "off the normal of a face"),
        (PlanarPose(-0.1, 0.05, 0.3), "turns the block"),
        (PlanarPose(0.1, 0.0), "is 200.0 mm long; allowed: 2 to 115"),
    ],
)
def test_pushes_go_straight_along_a_face_and_not_too_far(
    problem: Problem, end: PlanarPose, fault: str
) -> None:
    assert fault in faults(problem, Push("a", HERE, end))


def test_an_action_that_starts_elsewhere_is_seen(problem: Problem) -> None:
    assert "but the block stands at" in faults(
        problem, PickPlace("a", replace(HERE, x=-0.12), THERE, grasp=0)
    )


def test_an_end_outside_the_workspace_is_seen(problem: Problem) -> None:
    assert "ends outside the workspace" in faults(
        problem, PickPlace("a", HERE, PlanarPose(0.29, 0.0), grasp=0)
    )


def test_a_yaw_counts_up_to_the_symmetry(problem: Problem) -> None:
    turned = PickPlace("a", HERE, PlanarPose(0.1, 0.0, 1.5707963), grasp=0)
    assert "a does not end at its goal" in faults(problem, turned)
    assert "goal" not in faults(replace(problem, symmetry=4), turned)


def test_unknown_blocks_are_named(problem: Problem) -> None:
    assert faults(problem, PickPlace("z", HERE, THERE, 0)).endswith("there is no such block")
