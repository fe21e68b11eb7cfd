"""Moves of the blocks cell's arm, checked before they start."""

from __future__ import annotations

import numpy as np
import pytest

from pack_core.motion.moves import JointMove, Line, Path, PoseMove
from pack_core.motion.target import MotionTarget
from pack_core.motion.world import CarriedBox, Obstacle
from pack_core.rotations import Pose, from_yaw
from pack_motion.arm.arm import MotionArm
from pack_motion.reference.path_planner import MotionPlan
from pack_motion.reference.trajectory import JointState, MoveRefused
from pack_motion.target_planner import TargetPlanner
from pack_motion.tracking.config import motion_set
from unit.pack_motion.loop import pose

SIDE, TIP = 0.0508, 0.0308
WIDE = SIDE + 0.008
TABLE = Obstacle("table", Pose(np.array([0.45, 0.0, -0.02])), np.array([1.5, 1.2, 0.04]))
X, Y = 0.65, 0.05
GRIP = pose(X, Y, TIP)
DOWN = Path((PoseMove(pose(X, Y, 0.13), 0.6, 0.6, label="approach"), Line(GRIP, 0.25, entry_speed=0.25)))


def block(name: str, x: float, y: float, yaw: float = 0.0) -> Obstacle:
    return Obstacle(name, Pose(np.array([x, y, SIDE / 2]), from_yaw(yaw)), np.full(3, SIDE))


class Bench:
    """Plans from the arm's look-out."""

    def __init__(self, arm: MotionArm) -> None:
        config = motion_set("shipped")
        self.arm, self.planner = arm, TargetPlanner(arm, config.clearance, config.limit_share)

    def plan(
        self, move: Path, *blocks: Obstacle, opening: float = WIDE, start: MotionPlan | None = None
    ) -> MotionPlan:
        state = start.trajectory.end if start else JointState.at_rest(self.arm.home)
        return self.planner.plan(state, MotionTarget(1, move, obstacles=(TABLE, *blocks), opening=opening))


@pytest.fixture(scope="module")
def bench(small_arm: MotionArm) -> Bench:
    return Bench(small_arm)


def test_fingers_go_down_around_a_block_between_others_that_leave_them_room(bench: Bench) -> None:
    room = SIDE + 0.0221
    plan = bench.plan(DOWN, block("a", X, Y), block("b", X + room, Y), block("c", X, Y + SIDE + 0.002))
    reached = bench.arm.chain.forward(plan.trajectory.end.q)
    np.testing.assert_allclose(reached.p, GRIP.p, atol=1e-4)


def test_a_finger_that_would_meet_a_neighbour_is_named_with_it(bench: Bench) -> None:
    with pytest.raises(MoveRefused, match=r"'finger_\w+' would be .* 'b' in 'line'"):
        bench.plan(DOWN, block("a", X, Y), block("b", X + SIDE + 0.012, Y))


def test_narrow_fingers_go_where_wide_ones_do_not(bench: Bench) -> None:
    neighbours = block("b", X + 0.05, Y), block("c", X - 0.05, Y)
    bench.plan(DOWN, *neighbours, opening=0.010)
    with pytest.raises(MoveRefused, match="finger"):
        bench.plan(DOWN, *neighbours, opening=WIDE)


def test_a_tool_that_would_go_through_the_table_is_refused(bench: Bench) -> None:
    with pytest.raises(MoveRefused, match="'table'"):
        bench.plan(Path((PoseMove(pose(X, Y, -0.01), label="approach"),)))


def test_a_carried_block_that_would_be_put_onto_another_is_refused(bench: Bench) -> None:
    at = bench.plan(DOWN, block("a", X, Y))
    held = CarriedBox(Pose(np.array([0.0, 0.0, TIP - SIDE / 2])), np.full(3, SIDE))
    over = 0.11
    path = Path((
        Line(pose(X, Y, over), blend=0.03, label="lift"), Line(pose(X, -Y, over), blend=0.03, label="carry"),
        Line(pose(X, -Y, TIP), label="lower"),
    ))  # fmt: skip
    for offset, fits in ((SIDE + 0.002, True), (SIDE - 0.01, False)):
        target = MotionTarget(
            1, path, held, (TABLE, block("b", X, -Y - offset)), frozenset({"table"}), opening=SIDE
        )
        if fits:
            bench.planner.plan(at.trajectory.end, target)
        else:
            with pytest.raises(MoveRefused, match=r"'carried object' would be .* 'b'"):
                bench.planner.plan(at.trajectory.end, target)


def test_an_arm_that_would_fold_onto_itself_is_refused(bench: Bench) -> None:
    folded = bench.arm.home.copy()
    folded[1:4] = -1.6, 3.0, -1.6
    with pytest.raises(MoveRefused, match=r"'\w+' would be .* 'ur10e_\w+' in 'fold'"):
        bench.planner.plan(
            JointState.at_rest(bench.arm.home), MotionTarget(1, Path((JointMove(folded, label="fold"),)))
        )


def test_a_tool_that_is_sent_beside_the_base_is_refused(bench: Bench) -> None:
    with pytest.raises(MoveRefused, match=r"'\w+' would be .* 'ur10e_\w+' in 'to the base'"):
        bench.planner.plan(
            JointState.at_rest(bench.arm.home),
            MotionTarget(1, Path((PoseMove(pose(0.22, -0.1, 0.05), label="to the base"),))),
        )
