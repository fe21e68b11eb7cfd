"""Motions of the empty cup."""

from __future__ import annotations

import numpy as np
import pytest

from pack_core.packing.cell import packing_cell
from pack_core.packing.model import UPSIDE_DOWN
from pack_core.rotations import angle_between, from_yaw, multiply
from pack_mpc.filling.tool_motion import PERIOD, PathLeg, ToolArm, legs

CELL = packing_cell()
ARM = ToolArm(CELL)
HOME = np.array(CELL.robot.home)
WAYS = [np.array([0.0, 0.0, -0.1]), np.array([-0.08, -0.3, 0.0]), np.array([0.0, 0.0, -0.15])]
DOWN = multiply(from_yaw(0.3), np.array(UPSIDE_DOWN))


@pytest.mark.parametrize("overlap", [0.0, 0.35])
def test_a_motion_ends_where_its_legs_add_up_to_and_as_it_is_turned(overlap: float) -> None:
    motion = ARM.plan(HOME, 2.0, legs(WAYS, 0.7, overlap), DOWN)
    start, end = ARM.cup(HOME), ARM.cup(motion.q[-1])
    np.testing.assert_allclose(end.p, start.p + sum(WAYS), atol=5e-4)
    assert angle_between(end.q, DOWN) < 2e-3
    assert motion.start == 2.0
    assert np.abs(motion.v[[0, -1]]).max() == 0.0


def test_the_cup_keeps_its_speed_and_the_joints_their_limits() -> None:
    motion = ARM.plan(HOME, 0.0, legs(WAYS, 0.7), DOWN)
    places = np.array([ARM.cup(q).p for q in motion.q])
    assert np.linalg.norm(np.diff(places, axis=0), axis=1).max() / PERIOD < 0.72
    limits = CELL.robot.arm.limits
    assert np.all((motion.q >= limits.lower) & (motion.q <= limits.upper))
    assert np.all(np.abs(motion.v) <= limits.velocity)
    assert np.all(np.abs(motion.tau) <= limits.effort)


def test_setpoints_follow_the_clock_and_hold_the_end() -> None:
    motion = ARM.plan(HOME, 1.0, [PathLeg(np.array([0.0, 0.0, 0.05]), 0.0, 0.4)])
    rows = motion.setpoints(1.205)
    assert rows.time == pytest.approx(1.2)
    np.testing.assert_array_equal(rows.q[0], motion.q[10])
    over = motion.setpoints(5.0)
    assert np.all(over.q == motion.q[-1])
    assert not over.v.any()


def test_a_position_just_outside_a_limit_is_brought_back_inside() -> None:
    beyond = HOME.copy()
    beyond[6] = CELL.robot.arm.limits.upper[6] + 1e-4
    motion = ARM.plan(beyond, 0.0, [PathLeg(np.array([0.0, 0.0, 0.01]), 0.0, 0.2)])
    assert np.all(motion.q <= CELL.robot.arm.limits.upper)
