"""A stop of all joints, from any state within their limits."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from pack_core.robots.ur10e import LIMITS
from pack_sim.brakes import GentleStop

START = 5.0
TIMES = START + np.arange(0.0, 2.0, 0.02)
shares = st.lists(st.floats(-1.0, 1.0), min_size=6, max_size=6).map(np.array)
moving = st.lists(st.floats(0.05, 1.0) | st.floats(-1.0, -0.05), min_size=6, max_size=6).map(np.array)


@given(shares, shares)
def test_no_joint_gains_speed_or_turns_round_and_all_come_to_rest(
    speeds: np.ndarray, accelerations: np.ndarray
) -> None:
    v, a = speeds * LIMITS.velocity, accelerations * LIMITS.acceleration
    stop = GentleStop(START, (np.zeros(6), v, a), LIMITS, 0.5)
    rows = np.array([stop.at(time)[1] for time in TIMES])
    assert np.all(np.abs(rows) <= np.abs(v) + 1e-9)
    assert np.all(rows * np.sign(v) >= -1e-9)
    np.testing.assert_allclose(rows[-1], 0.0, atol=1e-9)


@given(moving)
def test_what_was_braking_goes_on_to_brake_without_a_jump(speeds: np.ndarray) -> None:
    v = speeds * LIMITS.velocity
    a = -0.3 * np.sign(v) * LIMITS.acceleration
    stop = GentleStop(START, (np.zeros(6), v, a), LIMITS, 0.5)
    np.testing.assert_allclose(stop.at(START)[2], a, atol=1e-9)
