"""A stop of all joints, from any state within their limits."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from pack_core.robots.ur10e import LIMITS
from pack_sim.gentle_stop import GentleStop

START = 5.0
TIMES = START + np.arange(0.0, 2.0, 0.02)
shares = st.lists(st.floats(-1.0, 1.0), min_size=6, max_size=6).map(np.array)


@given(shares, shares)
def test_a_joint_that_speeds_up_or_stands_gains_no_speed_and_comes_to_rest(
    speeds: np.ndarray, accelerations: np.ndarray
) -> None:
    v, a = speeds * LIMITS.velocity, accelerations * LIMITS.acceleration
    stop = GentleStop(START, (np.zeros(6), v, a), LIMITS, 0.5)
    rows = np.array([stop.at(time)[1] for time in TIMES])
    was_braking = v * a < 0.0
    assert np.all(np.abs(rows) <= np.abs(v) + 1e-9, where=~was_braking)
    np.testing.assert_allclose(rows[-1], 0.0, atol=1e-9)


@given(shares)
def test_what_was_braking_goes_on_to_brake_without_a_jump(speeds: np.ndarray) -> None:
    v = speeds * LIMITS.velocity
    a = -0.3 * np.sign(v) * LIMITS.acceleration
    stop = GentleStop(START, (np.zeros(6), v, a), LIMITS, 0.5)
    np.testing.assert_allclose(stop.at(START)[2], a, atol=1e-9)
