"""Motions of the empty cup."""

from __future__ import annotations

import numpy as np
import pytest

from pack_core.packing.cell import packing_cell
from pack_core.rotations import POINTING_DOWN, Array, angle_between, from_yaw, multiply
from pack_mpc.filling.fill_config import FillConfig
from pack_mpc.filling.tool_motion import PERIOD, CupMotion, CupPace, ToolArm, lines

CELL, CONFIG = packing_cell(), FillConfig()
ARM, LIMITS = ToolArm(CELL), CELL.robot.arm.limits
HOME = np.array(CELL.robot.home)
WAYS = [np.array([0.0, 0.0, -0.1]), np.array([-0.08, -0.3, 0.0]), np.array([0.0, 0.0, -0.15])]
DOWN = multiply(from_yaw(0.3), POINTING_DOWN)


def planned(
    *ways: tuple[float, ...] | Array, speed: float = 0.7, q_WT: Array | None = None, q: Array = HOME
) -> CupMotion:
    pace = CupPace(speed, CONFIG.acceleration)
    return ARM.plan(q, 2.0, lines(ARM.cup(q), [np.array(way) for way in ways], pace, CONFIG, q_WT))


@pytest.mark.parametrize("q_WT", [None, DOWN, multiply(from_yaw(2.0), POINTING_DOWN)])
def test_a_motion_ends_where_its_ways_add_up_to_and_as_it_is_turned(q_WT: Array | None) -> None:
    motion = planned(*WAYS, q_WT=q_WT)
    start, end = ARM.cup(HOME), ARM.cup(motion.q[-1])
    np.testing.assert_allclose(end.p, start.p + sum(WAYS), atol=2e-4)
    assert angle_between(end.q, start.q if q_WT is None else q_WT) < 1e-3
    assert motion.start == 2.0
    assert np.abs(motion.v[[0, -1]]).max() < 1e-3


def test_the_cup_keeps_its_speed_and_the_joints_their_limits() -> None:
    motion = planned(*WAYS, q_WT=DOWN)
    places = np.array([ARM.cup(q).p for q in motion.q])
    assert np.linalg.norm(np.diff(places, axis=0), axis=1).max() / PERIOD < 0.7 + 1e-3
    assert np.all((motion.q >= LIMITS.lower) & (motion.q <= LIMITS.upper))
    assert np.all(np.abs(motion.v) <= LIMITS.velocity)
    assert np.all(np.abs(np.diff(motion.v, axis=0)) / PERIOD <= LIMITS.acceleration + 1e-6)
    assert np.all(np.abs(motion.tau) <= LIMITS.effort)


def test_rows_are_each_others_derivatives() -> None:
    motion = planned(*WAYS, q_WT=DOWN)
    mean = 0.5 * (motion.v[1:] + motion.v[:-1])
    np.testing.assert_allclose(np.diff(motion.q, axis=0) / PERIOD, mean, atol=0.01)


def test_corners_are_rounded_and_passed_without_a_stop() -> None:
    ways = [np.array([0.0, 0.0, 0.1]), np.array([-0.08, -0.3, 0.0]), np.array([0.0, 0.0, -0.15])]
    motion = planned(*ways, q_WT=DOWN)
    places = np.array([ARM.cup(q).p for q in motion.q])
    speeds = np.linalg.norm(np.diff(places, axis=0), axis=1) / PERIOD
    moving = speeds[5:-5]
    assert moving.min() > 0.05
    corner = ARM.cup(HOME).p + ways[0]
    assert 0.005 < np.linalg.norm(places - corner, axis=1).min() < CONFIG.corner


def test_setpoints_follow_the_clock_and_hold_the_end() -> None:
    motion = planned((0.0, 0.0, 0.05))
    rows = motion.setpoints(2.105)
    assert rows.time == pytest.approx(2.1)
    np.testing.assert_array_equal(rows.q[0], motion.q[5])
    over = motion.setpoints(6.0)
    assert np.all(over.q == motion.q[-1])
    assert not over.v.any()


def test_a_position_just_outside_a_limit_is_brought_back_inside() -> None:
    beyond = HOME.copy()
    beyond[6] = LIMITS.upper[6] + 1e-4
    assert np.all(planned((0.0, 0.0, 0.01), q=beyond).q <= LIMITS.upper)


@pytest.mark.parametrize("way", [(0.0, 0.0, 1.5), (1.5, 0.0, 0.0), (0.0, -2.0, 0.0)])
def test_where_a_path_leaves_the_arms_reach_the_motion_ends_on_it_at_rest(
    way: tuple[float, float, float],
) -> None:
    motion, start = planned(way, speed=0.4), ARM.cup(HOME)
    went = ARM.cup(motion.q[-1]).p - start.p
    along = went @ way / np.linalg.norm(way)
    assert 0.1 < along < 0.99 * np.linalg.norm(way)
    assert np.linalg.norm(went - along * np.array(way) / np.linalg.norm(way)) < 1e-3
    assert np.all(np.abs(motion.v) <= LIMITS.velocity)
    assert np.all(np.abs(np.diff(motion.v, axis=0)) / PERIOD <= LIMITS.acceleration + 1e-6)
    assert np.abs(motion.v[-1]).max() < 1e-3


def test_a_turn_on_the_spot_ends_where_it_began() -> None:
    motion = planned((0.0, 0.0, 0.0), q_WT=DOWN)
    end = ARM.cup(motion.q[-1])
    assert np.linalg.norm(end.p - ARM.cup(HOME).p) < 2e-4
    assert angle_between(end.q, DOWN) < 1e-3


def test_no_way_is_no_motion() -> None:
    motion = planned((0.0, 0.0, 0.0))
    np.testing.assert_array_equal(motion.q, np.array([HOME, HOME]))


@pytest.mark.parametrize("up", [2e-4, 1e-3, 5e-3])
def test_a_short_first_way_with_hardly_a_turn_is_rounded_like_any_other(up: float) -> None:
    q_WT = multiply(from_yaw(0.03), ARM.cup(HOME).q)
    ways = [np.array([0.0, 0.0, up]), np.array([-0.08, -0.3, 0.0]), np.array([0.0, 0.0, -0.15])]
    end = ARM.cup(planned(*ways, q_WT=q_WT).q[-1])
    np.testing.assert_allclose(end.p, ARM.cup(HOME).p + sum(ways), atol=2e-4)
    assert angle_between(end.q, q_WT) < 1e-3
