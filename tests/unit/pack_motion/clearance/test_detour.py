"""Ways around what no height clears."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from pack_core.motion.moves import JointMove, Path, PoseMove
from pack_core.motion.world import CarriedBox, Obstacle
from pack_core.rotations import Array, Pose
from pack_motion.arm.arm import MotionArm
from pack_motion.clearance.check import ClearanceCheck, Conflict, Surrounding
from pack_motion.clearance.detour import DetourSearch, Tree
from pack_motion.clearance.transfer import TransferPlanner
from pack_motion.reference.path_planner import MotionPlan, PathPlanner
from pack_motion.reference.trajectory import JointState
from pack_motion.tracking.config import motion_set
from unit.pack_motion.clearance.test_transfer import BOX, DECK, PICK, PLACE, TABLE, transfer
from unit.pack_motion.loop import SHARE

MARGIN = 0.05
COLUMN = Obstacle("column", Pose(np.array([-0.9, 2.2, 2.25])), np.array([0.3, 0.3, 4.5]))
AROUND = Surrounding((TABLE, DECK, COLUMN), BOX, frozenset({"table", "pallet"}))


class Bench:
    def __init__(self, arm: MotionArm) -> None:
        self.arm, self.config = arm, motion_set("shipped")
        paths, self.check = PathPlanner(arm, SHARE), ClearanceCheck(arm, self.config.clearance)
        self.transfers = TransferPlanner(arm, paths, self.check)
        self.start = paths.plan(JointState.at_rest(arm.home), Path((PoseMove(PICK),))).trajectory.end
        self.start = JointState.at_rest(self.start.q)

    def over(self, X_WT: Pose) -> Array:
        """Joint positions half a metre over a pose."""
        raised = Pose(X_WT.p + np.array([0.0, 0.0, 0.5]), X_WT.q)
        found = self.arm.inverse.follow(raised, self.start.q, self.arm.inverse.branch(self.start.q))
        assert found is not None
        return found

    def way(self, around: Surrounding) -> list[Array] | None:
        is_clear = self.check.gate(around, MARGIN)
        search = DetourSearch(self.arm, is_clear, np.random.default_rng(0))
        return search.way(self.over(PICK), self.over(PLACE))


@pytest.fixture(scope="module")
def bench(arm: MotionArm) -> Bench:
    return Bench(arm)


def test_the_nearest_of_a_tree_is_by_the_time_of_the_slowest_joint() -> None:
    tree = Tree(np.array([0.0, 0.0]))
    far = tree.add(np.array([1.0, 0.0]), 0)
    near = tree.add(np.array([0.0, 1.5]), far)
    assert tree.nearest(np.array([1.0, 1.5]), np.array([1.0, 2.0])) == far
    assert tree.nearest(np.array([1.0, 1.5]), np.array([2.0, 1.0])) == near
    np.testing.assert_array_equal(tree.way(near), [[0.0, 1.5], [1.0, 0.0], [0.0, 0.0]])


def test_a_way_begins_and_ends_where_it_should_and_keeps_its_margin(bench: Bench) -> None:
    way = bench.way(AROUND)
    assert way is not None
    np.testing.assert_array_equal(way[0], bench.over(PICK))
    np.testing.assert_array_equal(way[-1], bench.over(PLACE))
    is_clear = bench.check.gate(AROUND, MARGIN - 0.005)  # between two moments that were looked at
    assert all(is_clear(np.linspace(a, b, 500)) for a, b in pairwise(way))


def test_the_same_seed_finds_the_same_way(bench: Bench) -> None:
    one, other = bench.way(AROUND), bench.way(AROUND)
    assert one is not None
    assert other is not None
    np.testing.assert_array_equal(one, other)


def test_nothing_in_the_way_leaves_one_straight_edge(bench: Bench) -> None:
    way = bench.way(Surrounding((), BOX))
    assert way is not None
    assert len(way) == 2


def test_a_transfer_goes_around_a_column_that_no_height_clears(bench: Bench) -> None:
    found = bench.transfers.by_height(bench.start, transfer(), AROUND)
    assert isinstance(found, Conflict)
    assert found.obstacle == "column"
    plan = bench.transfers.plan(bench.start, transfer(), AROUND)
    assert bench.check.conflict(plan, AROUND) is None
    assert any(isinstance(segment, JointMove) for segment in plan.segments)
    np.testing.assert_allclose(plan.trajectory.q[0], bench.start.q, atol=1e-12)
    np.testing.assert_allclose(plan.X_WT.p, PLACE.p, atol=1e-6)


def test_where_height_is_enough_no_way_around_is_taken(bench: Bench) -> None:
    around = Surrounding((TABLE, DECK), CarriedBox(BOX.X_TB, BOX.size), AROUND.contacts)
    by_height = bench.transfers.by_height(bench.start, transfer(), around)
    plan = bench.transfers.plan(bench.start, transfer(), around)
    assert isinstance(by_height, MotionPlan)
    np.testing.assert_array_equal(plan.trajectory.q, by_height.trajectory.q)
