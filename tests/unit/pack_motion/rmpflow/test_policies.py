from __future__ import annotations

import numpy as np
import pytest

from pack_motion.rmpflow import policies
from pack_motion.rmpflow.parameters import PointTarget
from pack_motion.tracking.config import motion_set

TABLE = motion_set("table_4_1")
STILL = np.zeros(3)
ISAAC, CUMOTION = (30.0, 85.0), (80.0, 120.0)


def time_to_close(gains: PointTarget, distance: float, until: float, h: float = 1e-4) -> tuple[float, float]:
    """Time to come within `until`, and the highest speed, of a point that only has this policy."""
    x, v, time, highest = distance, 0.0, 0.0, 0.0
    while x > until:
        a, _ = policies.target(np.array([-x, 0.0, 0.0]), np.array([-v, 0.0, 0.0]), STILL, gains)
        v += h * a[0]
        x, time, highest = x + h * v, time + h, max(highest, -v)
    return time, highest


@pytest.mark.parametrize(
    ("gains", "far_speed", "seconds"),
    [
        (ISAAC, 0.35, 4.2),
        (CUMOTION, 0.67, 2.2),
        ((TABLE.fast.target.accel_p_gain, TABLE.fast.target.accel_d_gain), 2.80, 0.52),
        ((TABLE.slow.target.accel_p_gain, TABLE.slow.target.accel_d_gain), 2.73, 0.54),
    ],
)
def test_a_point_target_is_approached_at_the_ratio_of_its_gains(
    gains: tuple[float, float], far_speed: float, seconds: float
) -> None:
    target = TABLE.fast.target._replace(accel_p_gain=gains[0], accel_d_gain=gains[1])
    time, highest = time_to_close(target, 1.0, 0.002)
    p, d, eps = target.accel_p_gain, target.accel_d_gain, target.accel_norm_eps
    assert p / d == pytest.approx(far_speed, rel=0.01)
    assert highest == pytest.approx(p / d / (1.0 + eps), rel=0.03)
    assert time == pytest.approx(d / p * (0.998 + eps * np.log(1.0 / 0.002)), rel=0.03)
    assert time == pytest.approx(seconds, rel=0.04)


def test_the_pull_to_a_point_is_normalised_where_the_thesis_prints_a_spring() -> None:
    """Eq. 4.7 as printed pulls with K_p times the distance: 14 m/s^2 at 1 cm with Table 4.1."""
    c = TABLE.fast.target
    pulls = [policies.target(np.array([d, 0.0, 0.0]), STILL, STILL, c)[0][0] for d in (1e-6, 0.01, 10.0)]
    assert pulls[0] == pytest.approx(c.accel_p_gain / c.accel_norm_eps * 1e-6, rel=1e-4)
    assert pulls[1] == pytest.approx(164.7, abs=0.1)
    assert pulls[2] == pytest.approx(c.accel_p_gain, rel=0.01)


def test_a_far_target_weighs_in_its_direction_only_and_a_near_one_in_all() -> None:
    c = TABLE.fast.target
    _, far = policies.target(np.array([1.0, 0.0, 0.0]), STILL, STILL, c)
    np.testing.assert_allclose(np.diag(far), [c.min_metric_scalar * 0.99 + 100.0, 100.0, 100.0], rtol=1e-6)
    _, near = policies.target(np.array([1e-6, 0.0, 0.0]), STILL, STILL, c)
    weight = c.proximity_metric_boost_scalar * c.max_metric_scalar
    np.testing.assert_allclose(near, weight * np.eye(3), rtol=1e-3, atol=1e-3 * weight)


def test_a_target_in_motion_that_is_kept_up_with_asks_for_its_own_acceleration() -> None:
    ahead = np.array([0.3, -0.2, 0.1])
    a, _ = policies.target(STILL, STILL, ahead, TABLE.fast.target)
    np.testing.assert_array_equal(a, ahead)


def test_a_posture_pulls_no_harder_than_its_threshold() -> None:
    c = TABLE.fast.cspace_target
    zero = np.zeros(6)
    near, far = (policies.cspace_target(np.full(6, d), zero, zero, c) for d in (0.01, 5.0))
    np.testing.assert_allclose(near, c.position_gain * 0.01)
    assert np.linalg.norm(far) == pytest.approx(c.position_gain * c.robust_position_term_thresh)


def test_the_end_of_a_range_pushes_back_and_weighs_more_the_nearer_it_is() -> None:
    c = TABLE.fast.joint_limit
    pushes, weights = zip(*(policies.joint_limit(x, -0.1, c) for x in (0.3, 0.1, 0.01, 0.001)), strict=True)
    assert list(pushes) == sorted(pushes)
    assert list(weights) == sorted(weights)
    leaving, coming = (policies.joint_limit(0.01, dx, c)[1] for dx in (1.0, -1.0))
    assert leaving < 1e-6 * coming


def test_a_speed_cap_sleeps_below_its_region_and_brakes_in_it() -> None:
    c = TABLE.fast.joint_velocity_cap
    assert policies.velocity_cap(6.4, 8.0, c) == (0.0, 0.0)
    for sign in (1.0, -1.0):
        push, weight = policies.velocity_cap(sign * 7.5, 8.0, c)
        assert push == pytest.approx(-sign * c.damping_gain * 1.0)
        assert weight == pytest.approx(c.metric_weight / (1.0 - (1.0 / 1.5) ** 2))


def test_an_obstacle_is_not_felt_beyond_its_radius_and_pushes_away_within() -> None:
    c = motion_set("shipped").fast.collision
    assert policies.collision(0.6, -1.0, 0.5, c) == (0.0, 0.0)
    far, near = (policies.collision(x, -0.2, 0.5, c) for x in (0.4, 0.02))
    assert 0.0 < far[0] < near[0]
    assert 0.0 < far[1] < near[1]
    assert policies.collision(0.02, 1.0, 0.5, c)[1] < 1e-6 * near[1]


def test_boost_is_one_far_away() -> None:
    assert policies.boost(0.0, 20.0, 0.02) == pytest.approx(20.0)
    assert policies.boost(1.0, 20.0, 0.02) == pytest.approx(1.0)
