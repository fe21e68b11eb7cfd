"""Motions of the empty cup."""

from __future__ import annotations

import numpy as np
import pytest

from pack_core.packing.cell import packing_cell
from pack_core.packing.model import UPSIDE_DOWN
from pack_core.rotations import angle_between, from_yaw, multiply
from pack_mpc.filling.tool_motion import LEAP, PERIOD, PathSegment, ToolArm, segments

CELL = packing_cell()
ARM = ToolArm(CELL)
HOME = np.array(CELL.robot.home)
WAYS = [np.array([0.0, 0.0, -0.1]), np.array([-0.08, -0.3, 0.0]), np.array([0.0, 0.0, -0.15])]
DOWN = multiply(from_yaw(0.3), np.array(UPSIDE_DOWN))


@pytest.mark.parametrize("overlap", [0.0, 0.35])
def test_a_motion_ends_where_its_legs_add_up_to_and_as_it_is_turned(overlap: float) -> None:
    motion = ARM.plan(HOME, 2.0, segments(WAYS, 0.7, overlap), DOWN)
    start, end = ARM.cup(HOME), ARM.cup(motion.q[-1])
    np.testing.assert_allclose(end.p, start.p + sum(WAYS), atol=5e-4)
    assert angle_between(end.q, DOWN) < 2e-3
    assert motion.start == 2.0
    assert np.abs(motion.v[[0, -1]]).max() == 0.0


def test_the_cup_keeps_its_speed_and_the_joints_their_limits() -> None:
    motion = ARM.plan(HOME, 0.0, segments(WAYS, 0.7), DOWN)
    places = np.array([ARM.cup(q).p for q in motion.q])
    assert np.linalg.norm(np.diff(places, axis=0), axis=1).max() / PERIOD < 0.72
    limits = CELL.robot.arm.limits
    assert np.all((motion.q >= limits.lower) & (motion.q <= limits.upper))
    assert np.all(np.abs(motion.v) <= limits.velocity)
    assert np.all(np.abs(motion.tau) <= limits.effort)


def test_setpoints_follow_the_clock_and_hold_the_end() -> None:
    motion = ARM.plan(HOME, 1.0, [PathSegment(np.array([0.0, 0.0, 0.05]), 0.0, 0.4)])
    rows = motion.setpoints(1.205)
    assert rows.time == pytest.approx(1.2)
    np.testing.assert_array_equal(rows.q[0], motion.q[10])
    over = motion.setpoints(5.0)
    assert np.all(over.q == motion.q[-1])
    assert not over.v.any()


def test_a_position_just_outside_a_limit_is_brought_back_inside() -> None:
    beyond = HOME.copy()
    beyond[6] = CELL.robot.arm.limits.upper[6] + 1e-4
    motion = ARM.plan(beyond, 0.0, [PathSegment(np.array([0.0, 0.0, 0.01]), 0.0, 0.2)])
    assert np.all(motion.q <= CELL.robot.arm.limits.upper)


@pytest.mark.parametrize("way", [(0.0, 0.0, 1.5), (1.5, 0.0, 0.0), (0.0, -2.0, 0.0)])
def test_where_a_path_leaves_the_arms_reach_the_motion_ends_on_it_and_no_joint_leaps(
    way: tuple[float, float, float],
) -> None:
    motion, start = ARM.plan(HOME, 0.0, segments([np.array(way)], 0.4)), ARM.cup(HOME)
    went = ARM.cup(motion.q[-1]).p - start.p
    along = went @ way / np.linalg.norm(way)
    assert 0.1 < along < 0.99 * np.linalg.norm(way)
    assert np.linalg.norm(went - along * np.array(way) / np.linalg.norm(way)) < 0.01
    assert np.all(np.abs(np.diff(motion.q, axis=0)) <= LEAP * PERIOD * CELL.robot.arm.limits.velocity)
    assert not motion.v[-1].any()


def test_a_path_that_begins_out_of_reach_is_no_motion() -> None:
    motion = ARM.plan(HOME, 0.0, [PathSegment(np.array([0.0, 0.0, 50.0]), 0.0, 0.2)])
    np.testing.assert_array_equal(motion.q, np.array([HOME, HOME]))
