from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pack_core.rotations import Array
from pack_motion.arm.arm import MotionArm
from pack_motion.reference.trajectory import JointState
from pack_motion.rmpflow.spheres import arm_spheres
from pack_motion.tracking.config import motion_set
from pack_motion.tracking.obstacles import ObstacleField
from pack_motion.tracking.tracker import (
    PolicyInputs,
    Tracker,
    acceleration_bounds,
    resolve_capped,
    resolve_within,
)

H = 0.004


@pytest.mark.parametrize("seed", range(3))
def test_no_wish_drives_a_joint_beyond_its_range_speed_or_acceleration(arm: MotionArm, seed: int) -> None:
    rng, limits = np.random.default_rng(seed), arm.limits
    q, v = arm.home.copy(), np.zeros(6)
    for k in range(3000):
        if k % 250 == 0:
            wish = rng.uniform(-50.0, 50.0, 6)
        lower, upper = acceleration_bounds(q, v, H, limits)
        assert np.all(lower <= upper)
        a = np.clip(wish, lower, upper)
        assert np.all(np.abs(a) <= limits.acceleration)
        q, v = q + H * (v + 0.5 * H * a), v + H * a
        assert np.all(np.abs(v) <= limits.velocity + 1e-9)
        assert np.all(q >= limits.lower - 1e-9)
        assert np.all(q <= limits.upper + 1e-9)


def problem(seed: int) -> tuple[Array, Array, Array, Array]:
    rng = np.random.default_rng(seed)
    A = rng.normal(size=(6, 6))
    return (
        A @ A.T * 1e4 + np.eye(6),
        rng.normal(size=6) * 1e4,
        -rng.uniform(0.1, 2.0, 6),
        rng.uniform(0.1, 2.0, 6),
    )


@given(seed=st.integers(0, 10_000))
@settings(max_examples=60)
def test_within_limits_no_allowed_change_is_better(seed: int) -> None:
    """The conditions of Karush, Kuhn and Tucker."""
    M, f, lower, upper = problem(seed)
    a = resolve_within(M, f, lower, upper)
    slope = (M @ a - f) / np.abs(f).max()
    at_lower, at_upper = a <= lower + 1e-9, a >= upper - 1e-9
    assert np.all(a >= lower - 1e-12)
    assert np.all(a <= upper + 1e-12)
    np.testing.assert_allclose(slope[~at_lower & ~at_upper], 0.0, atol=1e-6)
    assert np.all(slope[at_lower] >= -1e-6)
    assert np.all(slope[at_upper] <= 1e-6)


def test_wide_limits_leave_the_pseudo_inverse() -> None:
    M, f, _, _ = problem(1)
    wide = np.full(6, 1e6)
    np.testing.assert_allclose(resolve_within(M, f, -wide, wide), np.linalg.solve(M, f), rtol=1e-6)


def test_the_cap_shortens_and_keeps_the_direction() -> None:
    M, f, _, _ = problem(2)
    free, capped = resolve_capped(M, f, np.inf), resolve_capped(M, f, 0.1)
    assert np.linalg.norm(capped) == pytest.approx(0.1)
    np.testing.assert_allclose(capped / 0.1, free / np.linalg.norm(free), atol=1e-9)


@pytest.mark.parametrize("turns", [(1, 0, 0, 0, 0, 0), (-1, 0, 0, 2, 0, -3)])
def test_without_limits_an_arm_moves_alike_after_whole_turns_of_its_joints(
    arm: MotionArm, turns: tuple[int, ...]
) -> None:
    config, wound = motion_set("table_4_1"), 2.0 * np.pi * np.array(turns)
    seen = PolicyInputs(
        config.fast, arm_spheres(arm, config.first_sphere_link), ObstacleField.of((), config.fast.collision)
    )
    goal = JointState.at_rest(arm.home + 0.5)
    one, other = Tracker(arm, config, arm.home), Tracker(arm, config, arm.home + wound)
    for _ in range(50):
        for tracker in (one, other):
            tracker.step(H, goal, goal, arm.home, seen)
    assert np.abs(one.state.v).max() > 0.5
    np.testing.assert_allclose(other.state.q, one.state.q + wound, atol=1e-6)
