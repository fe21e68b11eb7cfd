from __future__ import annotations

from itertools import product

import numpy as np
import pytest

from pack_core.motion.moves import UP, Line, Path, PoseMove, Retreat, Transfer
from pack_core.motion.world import CarriedBox, Obstacle
from pack_core.rotations import Array, Pose
from pack_motion.arm.arm import MotionArm
from pack_motion.clearance.check import ClearanceCheck, Conflict, Surrounding, with_carried
from pack_motion.clearance.separation import gaps_along
from pack_motion.clearance.transfer import TransferPlanner
from pack_motion.reference.path_planner import MotionPlan, PathPlanner
from pack_motion.reference.trajectory import JointState, MoveRefused
from pack_motion.tracking.config import motion_set
from unit.pack_motion.loop import SHARE, pose

CLEARANCE = motion_set("shipped").clearance
SIZE = np.array([0.4, 0.3, 0.2])
PICK, PLACE = pose(-2.5, 2.5, 0.9), pose(-0.2, 0.5, 0.36)
BOX = CarriedBox(Pose(np.array([0.0, 0.0, 0.1])), SIZE)
TABLE = Obstacle("table", Pose(np.array([-2.5, 2.5, 0.35])), np.array([1.3, 1.1, 0.7]))
DECK = Obstacle("pallet", Pose(np.array([0.0, 0.5, 0.072])), np.array([1.2, 0.8, 0.144]))
CONTACTS = frozenset({"table", "pallet"})


def stack(height: float, x: float = 0.25) -> Obstacle:
    """A box on the pallet beside the place."""
    return Obstacle("stack", Pose(np.array([x, 0.5, 0.144 + 0.5 * height])), np.array([0.4, 0.6, height]))


def transfer() -> Transfer:
    lines = (
        Line(pose(-0.2, 0.5, 0.37), exit_speed=0.05, label="approach"),
        Line(PLACE, 0.05, label="insert"),
    )
    return Transfer(lines, hover=Retreat(UP, (0.07, 1.0)), depart=Retreat(UP, (0.06, 0.7)))


class Bench:
    """Everything that plans for one arm."""

    def __init__(self, arm: MotionArm) -> None:
        self.arm = arm
        self.paths, self.check = PathPlanner(arm, SHARE), ClearanceCheck(arm, CLEARANCE)
        self.transfers = TransferPlanner(arm, self.paths, self.check)
        self.at_pick = self.paths.plan(JointState.at_rest(arm.home), Path((PoseMove(PICK),))).trajectory.end

    def plan(self, *obstacles: Obstacle) -> MotionPlan:
        around = Surrounding((TABLE, DECK, *obstacles), BOX, CONTACTS)
        return self.transfers.plan(JointState.at_rest(self.at_pick.q), transfer(), around)

    def conflict(
        self, goal: Pose, obstacle: Obstacle, contacts: frozenset[str] = frozenset()
    ) -> Conflict | None:
        plan = self.paths.plan(JointState.at_rest(self.at_pick.q), Path((PoseMove(goal, label="over"),)))
        return self.check.conflict(plan, Surrounding((obstacle,), BOX, contacts))

    def least_gap(self, plan: MotionPlan, obstacle: Obstacle) -> float:
        """From the arm and its box, at every row of the transit [m]."""
        bodies, chain = with_carried(self.arm, Surrounding(carried=BOX)), self.arm.chain
        q = plan.trajectory.q[plan.trajectory.segment == 1]
        boxes = np.eye(3)[None], obstacle.X_WO.p[None].copy(), 0.5 * obstacle.size[None]
        gaps = gaps_along(
            chain.axes, chain.points, q, bodies.link, bodies.R, bodies.p, bodies.half, *boxes, 1.0
        )  # fmt: skip
        return float(gaps.min())


@pytest.fixture(scope="module")
def bench(arm: MotionArm) -> Bench:
    return Bench(arm)


def heights(plan: MotionPlan) -> Array:
    """How far it lifts and from how high it comes in [m]."""
    segments = plan.segments
    return np.array([segments[0].X_WT.p[2] - PICK.p[2], segments[1].X_WT.p[2] - 0.37])  # type: ignore[union-attr]


def test_with_nothing_in_the_way_both_lines_are_the_shortest(bench: Bench) -> None:
    start = JointState.at_rest(bench.at_pick.q)
    plan = bench.transfers.plan(start, transfer(), Surrounding((), BOX))
    np.testing.assert_allclose(heights(plan), [0.06, 0.07])
    assert [segment.label for segment in plan.segments] == ["depart", "transit", "approach", "insert"]
    assert np.linalg.norm(plan.X_WT.p - PLACE.p) < 1e-6


def test_the_higher_a_stack_in_the_way_the_farther_lines_reach_until_it_is_clear(bench: Bench) -> None:
    plans = [bench.plan(stack(height)) for height in (0.05, 0.3, 0.6)]
    reach = [heights(plan).sum() for plan in plans]
    assert reach[0] <= reach[1] <= reach[2]
    assert reach[0] < reach[2]
    for plan, height in zip(plans, (0.05, 0.3, 0.6), strict=True):
        assert bench.least_gap(plan, stack(height)) > CLEARANCE - 0.003


def test_a_neighbour_two_millimetres_away_at_the_place_is_no_hindrance(bench: Bench) -> None:
    neighbour = stack(0.25, -0.2 + 0.2 + 0.002 + 0.2)
    assert np.linalg.norm(bench.plan(neighbour).X_WT.p - PLACE.p) < 1e-6


def test_a_place_that_is_taken_is_refused_with_what_where_and_how_near(bench: Bench) -> None:
    words = r"'carried object' would be \d+ mm inside 'stack' in 'approach'.* at"
    with pytest.raises(MoveRefused, match=words):
        bench.plan(stack(0.25, -0.2 + 0.35))


def test_a_place_under_a_roof_is_refused(bench: Bench) -> None:
    roof = Obstacle("roof", Pose(np.array([-0.2, 0.5, 0.9])), np.array([1.0, 1.0, 0.05]))
    with pytest.raises(MoveRefused, match="'roof'"):
        bench.plan(roof)


def test_what_moves_is_not_planned_around(bench: Bench) -> None:
    thing = stack(0.6, -0.6)
    moving = Obstacle(thing.name, thing.X_WO, thing.size, is_moving=True)
    np.testing.assert_allclose(heights(bench.plan(moving)), heights(bench.plan()))


def test_a_contact_does_not_excuse_touching_on_the_way(bench: Bench) -> None:
    conflict = bench.conflict(pose(-0.2, 0.5, 0.9), stack(2.0, -1.2), frozenset({"stack"}))
    assert conflict is not None
    assert conflict.obstacle == "stack"
    assert "'over'" in conflict.text


def test_a_corner_that_is_passed_between_two_checked_moments_is_seen(bench: Bench) -> None:
    """A small block beside the way of the box's corners, at any row of the fast middle."""
    plan = bench.paths.plan(
        JointState.at_rest(bench.at_pick.q), Path((PoseMove(pose(-0.2, 0.5, 1.3), label="over"),))
    )
    bodies, chain = with_carried(bench.arm, Surrounding(carried=BOX)), bench.arm.chain
    q = np.ascontiguousarray(plan.trajectory.q)  # as the check has them, for which the gaps are compiled
    middle = int(np.argmax(np.linalg.norm(plan.trajectory.v, axis=1)))
    corners = 2.0 * np.indices((2, 2, 2)).reshape(3, -1).T - 1.0
    poses = [tuple(part[-1] for part in bodies.moved(*chain.links(row))) for row in q]
    ways = np.array([p + corners * bodies.half[-1] @ R.T for R, p in poses])
    too_near, missed = 0, []
    for row, corner in product(range(middle - 5, middle + 5), range(8)):
        along = ways[row + 1, corner] - ways[row - 1, corner]
        out = ways[row, corner] - poses[row][1]
        out -= (out @ along) / (along @ along) * along
        p = ways[row, corner] + 0.011 * out / np.linalg.norm(out)
        block = Obstacle("block", Pose(p), np.full(3, 0.002))
        boxes = np.eye(3)[None], p[None], 0.5 * block.size[None]
        gaps = gaps_along(
            chain.axes, chain.points, q, bodies.link, bodies.R, bodies.p, bodies.half, *boxes, 1.0
        )  # fmt: skip
        is_too_near = float(gaps.min()) < CLEARANCE
        too_near += is_too_near
        if is_too_near and bench.check.conflict(plan, Surrounding((block,), BOX)) is None:
            missed.append((row, corner))
    assert too_near > 40
    assert missed == []


def test_the_arm_itself_is_kept_clear(bench: Bench) -> None:
    elbow = bench.arm.bodies.names.index("kr210_link4")
    R, d = bench.arm.chain.links(bench.at_pick.q)
    p = bench.arm.bodies.moved(R, d)[1][elbow]
    post = Obstacle("post", Pose(p + np.array([0.0, 0.0, 0.2])), np.full(3, 0.1))
    conflict = bench.conflict(pose(-2.5, 2.4, 0.95), post)
    assert conflict is not None
    assert conflict.body.startswith("kr210_link")
