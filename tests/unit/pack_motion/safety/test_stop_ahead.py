"""The predicted stop, against stops whose time and way are known."""

from __future__ import annotations

import numpy as np
import pytest

from pack_core.rotations import Array
from pack_motion.safety.stop_ahead import rate_bounds, stop_ahead, ways_of_bodies


def constant(values: object) -> Array:
    """Read-only, as an arm's limits and axes are: for others all would be compiled anew."""
    array = np.array(values, dtype=float)
    array.flags.writeable = False
    return array


ONE = constant([[0.0, 0.0, 1.0]])
RISE, CYCLE = 0.3, 0.004


def even_plan(speed: float, duration: float = 4.0) -> tuple[Array, Array, Array, Array]:
    """One joint at an even speed [rad/s]."""
    times = np.linspace(0.0, duration, 1001)
    return times, speed * times[:, None], np.full((1001, 1), speed), np.zeros((1001, 1))


@pytest.mark.parametrize(("speed", "limit", "T_s"), [(0.5, 10.0, 0.05), (2.0, 4.0, 0.5), (1.5, 1.0, 1.5)])
def test_a_joint_at_an_even_speed_stops_as_fast_as_its_rate_and_its_limit_let_it(
    speed: float, limit: float, T_s: float
) -> None:
    way, braking, stopping = stop_ahead(*even_plan(speed), 0.4, 1.0, constant([limit]), CYCLE)
    assert stopping == pytest.approx(T_s, abs=1e-9)
    np.testing.assert_allclose(way[0], speed * 0.4)
    np.testing.assert_allclose(way[braking] - way[0], speed * CYCLE, atol=1e-9)
    np.testing.assert_allclose(way[-1] - way[braking], 0.5 * speed * T_s, rtol=0.02)


def test_a_plan_that_stands_needs_no_time_to_stop_and_any_rate_will_do() -> None:
    way, _, stopping = stop_ahead(*even_plan(0.0), 0.0, 0.0, constant([1.0]), CYCLE)
    assert stopping == 0.0
    assert np.ptp(way) == 0.0
    assert stop_ahead(*even_plan(0.0), 0.0, 1.0, constant([1.0]), CYCLE)[2] == 0.0
    assert rate_bounds(np.zeros(1), np.zeros(1), 0.5, constant([1.0]), RISE) == (-np.inf, np.inf)


def test_the_end_of_the_plan_is_the_end_of_the_stop() -> None:
    way, _, stopping = stop_ahead(*even_plan(1.0), 3.9, 1.0, constant([0.1]), CYCLE)
    assert way[-1, 0] == pytest.approx(4.0)
    assert stopping == pytest.approx(0.0965, abs=CYCLE)  # t - 0.1 t^2 / 2 is the rest of the plan, 0.096


def test_a_stop_that_has_begun_takes_a_cycle_less_in_each_cycle() -> None:
    """Until 2 s a joint brakes as hard as it can by the plan, so that the rate cannot fall before."""
    times = np.linspace(0.0, 6.0, 1501)
    v = np.stack([np.maximum(2.0 - times, 0.0), 0.5 + np.minimum(times, 2.0)], axis=1)
    q, a = np.cumsum(v, axis=0) * (times[1] - times[0]), np.gradient(v, times, axis=0)
    limit, clock, rate = constant([1.0, 3.0]), 1.9, 1.0
    before = stop_ahead(times, q, v, a, clock, rate, limit, CYCLE)[2]
    while rate > 0.0:
        clock += CYCLE * rate
        v_now, a_now = (np.array([np.interp(clock, times, rows[:, j]) for j in range(2)]) for rows in (v, a))
        rate = max(rate + CYCLE * rate_bounds(v_now, a_now, rate, limit, RISE)[0], 0.0)
        now = stop_ahead(times, q, v, a, clock, rate, limit, CYCLE)[2]
        assert now < before - 0.9 * CYCLE or rate == 0.0
        before = now


def test_the_rate_keeps_the_limit_of_a_joint_that_brakes_already() -> None:
    slowest, fastest = rate_bounds(np.array([1.0]), np.array([-2.0]), 1.0, constant([2.0]), RISE)
    assert slowest == 0.0
    assert fastest == pytest.approx(1.0 / RISE)


def test_a_corner_of_a_turning_box_goes_along_its_arc() -> None:
    """A box at 1 m from the axis: its outer corners are at the root of 1.1^2 + 0.1^2 from it."""
    way = np.linspace(0.0, 0.5, 101)[:, None]
    before, after = ways_of_bodies(
        ONE, constant([[0.0, 0.0, 0.0]]), way, 40, np.array([0]), np.eye(3)[None],
        np.array([[1.0, 0.0, 0.0]]), np.full((1, 3), 0.1),
    )  # fmt: skip
    radius = np.hypot(1.1, 0.1)
    np.testing.assert_allclose([before[0], after[0]], [0.2 * radius, 0.3 * radius], rtol=1e-4)
