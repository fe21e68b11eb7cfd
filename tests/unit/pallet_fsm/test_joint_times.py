"""Of all ways to take a box and to put it down, the quickest for the joints comes first."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from pack_core.palletizing.arm import arm_kinematics
from pack_core.palletizing.cell import palletizing_cell
from pack_core.palletizing.orders.handling import Handling
from pack_core.palletizing.orders.item_list import Item, order_box
from pack_core.palletizing.orders.layout_plan import Insertion, PlannedBox
from pack_core.palletizing.orders.placed_box import PlacedBox
from pack_core.robots.joint_properties import FLIP, LONG_WAY
from pack_core.robots.kr210 import LIMITS
from pack_core.rotations import Pose, from_yaw
from pallet_fsm.goals import BACK, OBLIQUE, Goals, joint_time
from pallet_fsm.order_book import WorkItem
from pallet_fsm.palletizer_config import ToolPoseConfig
from pallet_fsm.tool_poses import Stand, grasps, placements, stands
from unit.pallet_fsm.fake_shift import CELL as SHIFT_CELL
from unit.pallet_fsm.whole_orders import given_order

CELL, POSES, ARM = palletizing_cell(), ToolPoseConfig(), arm_kinematics()
TURNED = [box for n in range(1, 26) for box in given_order(n).boxes if box.turn.handling is Handling.TABLE]


def pose_at(*steps: float) -> Pose:
    """Pose of the tool with the joints so far from home [rad]."""
    return ARM.chain.forward(ARM.home + np.array(steps))


@pytest.mark.parametrize(("joint", "step"), [(0, 2.0), (1, 0.2), (5, -2.5)])
def test_a_turn_of_one_joint_takes_the_time_of_its_trapezoid(joint: int, step: float) -> None:
    steps = np.zeros(6)
    steps[joint] = step
    v, a = LIMITS.velocity[joint], LIMITS.acceleration[joint]
    alone = abs(step) / v + v / a if abs(step) * a > v**2 else 2.0 * np.sqrt(abs(step) / a)
    assert joint_time(pose_at(*np.zeros(6)), pose_at(*steps)) == pytest.approx((1.0 + LONG_WAY) * alone)


def test_the_way_back_takes_as_long() -> None:
    one, other = pose_at(0.3, 0.1, -0.2, 0.0, 0.3, 1.0), pose_at(-1.0, 0.2, 0.1, 1.8, -0.4, -2.0)
    assert joint_time(one, other) == pytest.approx(joint_time(other, one), abs=FLIP)


def test_what_is_out_of_reach_takes_for_ever() -> None:
    assert joint_time(pose_at(*np.zeros(6)), Pose(np.array([9.0, 0.0, 1.0]))) == np.inf


def has_way_back(stand: Stand) -> bool:
    """Whether the arm can step straight back from a box that it has stood up."""
    return joint_time(stand.X_WT, Pose(stand.X_WT.p - BACK * stand.approach, stand.X_WT.q)) < np.inf


def test_a_box_is_stood_up_where_the_arm_can_step_straight_back() -> None:
    # Where table B stands in shifts, one of both edges is so near to the arm's base that it cannot.
    listed = Item(id="a", article="a", size=(0.413, 0.311, 0.121), weight=12.0, this_side_up=False)
    placed = PlacedBox("a", np.array([0.0, 0.0, 0.23]), np.array([0.413, 0.121, 0.311]), 12.0)
    box, start = order_box(listed, placed), pose_at(*np.zeros(6))
    X_WB = Pose(np.array([-1.3, 2.3, 0.8]))
    for pick in grasps(X_WB, np.array(box.dims), POSES):
        plan = PlannedBox(placed, Insertion("Up", np.zeros(3), 0.0))
        item = WorkItem(box, plan, X_WB=X_WB, X_TB=pick.inverse() @ X_WB)
        found = Goals(SHIFT_CELL, POSES).stands(item, start)
        assert {has_way_back(stand) for stand in found} == {True, False}
        assert has_way_back(found[0])


@pytest.mark.parametrize("box", TURNED[::20], ids=lambda box: box.id)
def test_a_box_is_taken_so_that_its_whole_way_over_table_b_is_the_quickest(box) -> None:
    dims, start = np.array(box.dims), pose_at(*np.zeros(6))
    placed = PlacedBox(box.id, np.array([0.3, 0.2, 0.4]), np.array(box.turn.extents), box.weight)
    X_WB = Pose(np.array([-2.4, 2.6, CELL.picking_table.height + 0.5 * dims[2]]), from_yaw(0.1))
    item = WorkItem(box, PlannedBox(placed, Insertion("Up", np.zeros(3), 0.0)), X_WB=X_WB)

    times = {}
    for k, pick in enumerate(grasps(X_WB, dims, POSES)):
        for stand in stands(box, pick.inverse() @ X_WB, CELL, POSES):
            for again in grasps(stand.X_WB, dims, POSES):
                X_TB = again.inverse() @ stand.X_WB
                for place in placements(placed, box, X_TB, CELL.pallet.X_WP, POSES):
                    way = (start, pick, stand.X_WT, again, place)
                    total = sum(joint_time(*leg) for leg in pairwise(way))
                    total += 0.0 if has_way_back(stand) else OBLIQUE
                    times[k] = min(total, times.get(k, np.inf))

    first = Goals(CELL, POSES).grasps(item, start)[0]
    all_goals = grasps(X_WB, dims, POSES)
    chosen = next(k for k, goal in enumerate(all_goals) if np.allclose(goal.q, first.q))
    assert times[chosen] == pytest.approx(min(times.values()))
