"""The verifier sees what is wrong with a plan."""

import re
from dataclasses import replace

import numpy as np
import pytest

from pack_core.blocks.gripper import GripperFootprint
from pack_core.blocks.plan import PickPlace, Plan, PlanStatus, Push
from pack_core.blocks.planar import PlanarPose
from pack_core.blocks.primitive_action import primitives_of
from pack_core.blocks.problem import CUBE_SIDE, BlockSize, PlacedBlock, Problem
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


def test_a_block_without_a_goal_is_to_stay(problem: Problem) -> None:
    problem = replace(problem, goals={"a": THERE})
    there = problem.starts["c"]
    text = faults(problem, PickPlace("c", there, replace(there, x=0.0), 0))
    assert text == "action 1 (PickPlace c): it has no goal, and is to stay"


def test_what_the_arm_refused_is_seen(problem: Problem) -> None:
    action = PickPlace("a", HERE, THERE, 0)
    assert faults(replace(problem, refused=tuple(primitives_of(action))), action).endswith(
        "is what the arm refused"
    )


SIDE, EDGE = 0.05, 1e-4
HALF = SIDE / 2
GRIPPER = GripperFootprint(
    finger_width=0.030, finger_tip_thickness=0.006, finger_taper=0.5, insertion=0.020,
    opening_clearance=0.004, safety_margin=0.002, block_margin=0.001, push_gap=0.012, push_standoff=0.005,
)  # fmt: skip
START, YAW, WAY = PlanarPose(-0.1, -0.05, 0.3), 0.3, 0.08


def beside(pose: PlanarPose, x: float, y: float) -> PlanarPose:
    """The pose of a block parallel to another at `pose`, at x, y in the other's frame."""
    c, s = np.cos(pose.yaw), np.sin(pose.yaw)
    return PlanarPose(pose.x + c * x - s * y, pose.y + s * x + c * y, pose.yaw)


CUBE = BlockSize(SIDE, SIDE, SIDE)


def hits(action: PickPlace | Push, obstacle: PlanarPose, size: BlockSize = CUBE) -> set[str]:
    """What of the action a block that stands there is in the way of."""
    problem = Problem(
        blocks=(PlacedBlock("a", action.start, size), PlacedBlock("b", obstacle, CUBE)),
        goals={"a": action.end}, workspace=((-1, -1), (1, -1), (1, 1), (-1, 1)), gripper=GRIPPER,
    )  # fmt: skip
    found = (re.search("the (.*) hits b", fault) for fault in verify(problem, plan_of(action)))
    return {match[1] for match in found if match}


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(
    ("what", "of_end", "grasp", "x", "y"),
    [
        # A finger is 6 + 0.5 * 20 = 16 mm thick at the block's top, opened by 4 mm, with 2 mm around it.
        ("gripper at the pick", False, 0, HALF + 0.022 + HALF, 0.0),
        ("gripper at the pick", False, 0, HALF + 0.011, 0.017 + HALF),
        ("gripper at the pick", False, 1, 0.017 + HALF, HALF + 0.011),
        ("gripper at the place", True, 0, HALF + 0.022 + HALF, 0.0),
        ("gripper at the place", True, 1, 0.0, HALF + 0.022 + HALF),
        ("block put down", True, 0, 0.0, HALF + 0.001 + HALF),
        ("block put down", True, 1, HALF + 0.001 + HALF, 0.0),
    ],
)
def test_a_grasp_needs_the_room_of_its_fingers_and_of_the_block(
    sign: float, what: str, of_end: bool, grasp: int, x: float, y: float
) -> None:
    end = PlanarPose(0.3, 0.2, 1.1)
    action, offset = PickPlace("a", START, end, grasp), sign * np.array([x, y])
    outward = EDGE * np.sign(offset) * (np.abs(offset) >= SIDE - 0.01)
    inner, outer = (hits(action, beside(end if of_end else START, *(offset + k * outward))) for k in (-1, 1))
    assert what in inner
    assert what not in outer


@pytest.mark.parametrize("turn", [0, 1, 2, 3])
@pytest.mark.parametrize(
    ("what", "x", "y", "outward"),
    [
        ("block pushed", WAY + HALF + 0.001 + HALF, 0.0, (1, 0)),
        ("block pushed", WAY / 2, HALF + 0.001 + HALF, (0, 1)),
        ("block pushed", WAY / 2, -HALF - 0.001 - HALF, (0, -1)),
        ("block pushed", -HALF - HALF, 0.0, (-1, 0)),
        # Two fingers of 16 mm, 12 mm apart, with 2 mm around them; 5 mm behind the face to begin with.
        ("gripper pushing", -HALF - 0.005 - 0.030 - 0.002 - HALF, 0.0, (-1, 0)),
        ("gripper pushing", -HALF - 0.020 - HALF, 0.006 + 0.016 + 0.002 + HALF, (0, 1)),
        ("gripper pushing", -HALF - 0.020 - HALF, -0.006 - 0.016 - 0.002 - HALF, (0, -1)),
        ("gripper pushing", WAY - HALF + HALF, 0.0, (1, 0)),
    ],
)
def test_a_push_needs_the_room_of_the_block_and_of_the_fingers_behind_it(
    turn: int, what: str, x: float, y: float, outward: tuple[int, int]
) -> None:
    along = replace(START, yaw=YAW + turn * np.pi / 2)
    end = replace(beside(along, WAY, 0.0), yaw=YAW)
    action = Push("a", START, end)
    inner, outer = (
        hits(action, beside(along, x + k * EDGE * outward[0], y + k * EDGE * outward[1])) for k in (-1, 1)
    )
    assert what in inner
    assert what not in outer


def test_what_only_touches_is_not_hit() -> None:
    push = Push("a", PlanarPose(0.0, 0.0), PlanarPose(WAY, 0.0))
    assert hits(push, PlanarPose(WAY / 2, HALF + 0.001 + HALF)) == set()
    assert hits(push, PlanarPose(WAY / 2, -HALF - 0.001 - HALF)) == set()


@pytest.mark.parametrize(
    ("end", "fault"),
    [
        (PlanarPose(0.0, 0.0, 1e-5), "turns the block"),
        (PlanarPose(0.0, 1e-5), "off the normal of a face"),
        (PlanarPose(0.0, -1e-5), "off the normal of a face"),
        (PlanarPose(-0.1 + 0.0019, 0.0), "long"),
        (PlanarPose(-0.1 + 0.1151, 0.0), "long"),
    ],
)
def test_a_push_has_hardly_any_tolerance(problem: Problem, end: PlanarPose, fault: str) -> None:
    assert fault in faults(problem, Push("a", HERE, end))


@pytest.mark.parametrize("length", [0.002, 0.115])
@pytest.mark.parametrize("heading", [0.0, 0.5, -1.0, 2.0, 3.0])
def test_the_shortest_and_the_longest_push_are_allowed(length: float, heading: float) -> None:
    start = PlanarPose(0.0, 0.0, heading)
    push = Push("a", start, start.moved(length, heading - np.pi / 2))
    # The goal is farther off than a block that counts as standing there.
    problem = Problem(
        (PlacedBlock("a", start),), {"a": start.moved(0.01, 0.0)}, ((-1, -1), (1, -1), (1, 1), (-1, 1))
    )
    assert faults(problem, push) == "a does not end at its goal"


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_block_may_stand_at_the_border_and_not_over_it(problem: Problem, sign: float) -> None:
    for over, is_fault in ((0.0, False), (1e-5, True)):
        end = PlanarPose(-0.2, sign * (0.3 - CUBE_SIDE / 2 + over))
        assert ("outside the workspace" in faults(problem, PickPlace("a", HERE, end, 0))) is is_fault


@pytest.mark.parametrize(
    ("start", "is_fault"),
    [
        (PlanarPose(-0.1, 0.00099), False),
        (PlanarPose(-0.1, -0.00102), True),
        (PlanarPose(-0.1, 0.0, np.radians(1.99)), False),
        (PlanarPose(-0.1, 0.0, np.radians(-1.99)), False),
        (PlanarPose(-0.1, 0.0, np.radians(2.01)), True),
        (PlanarPose(-0.1, 0.0, np.radians(-2.01)), True),
    ],
)
def test_a_blocks_first_action_may_start_within_tolerance_of_where_it_was_measured(
    problem: Problem, start: PlanarPose, is_fault: bool
) -> None:
    assert ("starts at" in faults(problem, PickPlace("a", start, THERE, 0))) is is_fault


@pytest.mark.parametrize(
    ("off", "is_fault"),
    [
        (PlanarPose(0.0, 0.0), False),
        (PlanarPose(1e-5, 0.0), True),
        (PlanarPose(0.0, 0.0, 1e-5), True),
        (PlanarPose(0.0, 0.0, -1e-5), True),
    ],
)
def test_its_next_action_starts_exactly_where_the_one_before_ended(
    problem: Problem, off: PlanarPose, is_fault: bool
) -> None:
    middle = PlanarPose(0.0, 0.0)
    text = faults(problem, PickPlace("a", HERE, middle, 0), PickPlace("a", off, THERE, 0))
    assert ("action 2 (PickPlace a): starts at" in text) is is_fault


@pytest.mark.parametrize(
    ("end", "is_home"),
    [
        (PlanarPose(0.1, 0.0019), True),
        (PlanarPose(0.1, -0.0021), False),
        (PlanarPose(0.1, 0.0, np.radians(1.9)), True),
        (PlanarPose(0.1, 0.0, np.radians(-1.9)), True),
        (PlanarPose(0.1, 0.0, np.radians(-2.1)), False),
    ],
)
def test_a_goal_is_reached_within_tolerance(problem: Problem, end: PlanarPose, is_home: bool) -> None:
    assert ("does not end at its goal" in faults(problem, PickPlace("a", HERE, end, 0))) is not is_home


def test_a_block_that_counts_as_at_its_goal_is_taken_to_stand_there_exactly() -> None:
    quarter, off = np.pi / 2, np.radians(1.5)
    blocks = (PlacedBlock("a", PlanarPose(0.1, 0.0015, quarter + off)),)
    problem = replace(make_problem({"a": (100, 0)}), blocks=blocks, symmetry=4)
    aside = PlanarPose(0.0, 0.0, quarter)
    start = PlanarPose(0.1, -0.0009, quarter - off)  # 2.4 mm and 3 degrees from where it was measured
    plan = plan_of(PickPlace("a", start, aside, 0), PickPlace("a", aside, PlanarPose(0.1, 0.0), 0))
    assert verify(problem, plan) == []
    assert "starts at" in "".join(verify(replace(problem, symmetry=1), plan))


@pytest.mark.parametrize(("grasp", "edge"), [(0, 0.04), (1, 0.07)])
def test_the_fingers_stand_beside_the_faces_of_an_oblong_block(grasp: int, edge: float) -> None:
    action, size = PickPlace("a", START, PlanarPose(0.3, 0.2, 1.1), grasp), BlockSize(0.04, 0.07, SIDE)
    for way, is_hit in ((-EDGE, True), (EDGE, False)):
        away = edge / 2 + 0.022 + HALF + way
        where = beside(START, *((away, 0.0) if grasp == 0 else (0.0, away)))
        assert ("gripper at the pick" in hits(action, where, size)) == is_hit


def test_fingers_are_thicker_beside_a_taller_block() -> None:
    """10 mm above the top of their own block they are 5 mm thicker, with a taper of 0.5."""
    action, low = PickPlace("a", START, PlanarPose(0.3, 0.2, 1.1), 0), BlockSize(SIDE, SIDE, SIDE - 0.010)
    for way, is_hit in ((-EDGE, True), (EDGE, False)):
        where = beside(START, HALF + 0.027 + HALF + way, 0.0)
        assert ("gripper at the pick" in hits(action, where, low)) == is_hit


@pytest.mark.parametrize(("turn", "along", "across"), [(0, 0.04, 0.07), (1, 0.07, 0.04)])
def test_an_oblong_block_sweeps_what_its_pushed_face_is_wide(turn: int, along: float, across: float) -> None:
    direction = START.yaw + turn * np.pi / 2
    action = Push("a", START, START.moved(WAY, direction))
    size, ahead = BlockSize(0.04, 0.07, SIDE), PlanarPose(START.x, START.y, direction)
    for way, is_hit in ((-EDGE, True), (EDGE, False)):
        in_front = beside(ahead, WAY + along / 2 + 0.001 + HALF + way, 0.0)
        aside = beside(ahead, WAY, across / 2 + 0.001 + HALF + way)
        assert ("block pushed" in hits(action, in_front, size)) == is_hit
        assert ("block pushed" in hits(action, aside, size)) == is_hit


def test_a_grasp_wider_than_the_gripper_opens_is_a_fault() -> None:
    wide = BlockSize(0.04, 0.09, SIDE)
    for grasp, is_fault in ((0, False), (1, True)):
        action = PickPlace("a", START, PlanarPose(0.3, 0.2, 1.1), grasp)
        problem = Problem(
            (PlacedBlock("a", START, wide),), {"a": action.end}, ((-1, -1), (1, -1), (1, 1), (-1, 1))
        )
        assert any("needs an opening" in fault for fault in verify(problem, plan_of(action))) == is_fault
