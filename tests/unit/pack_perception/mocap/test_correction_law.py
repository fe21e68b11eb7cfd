"""How much of what is seen is believed."""

from __future__ import annotations

import numpy as np
import pytest

from pack_perception.mocap.physics_estimator import CorrectionConfig, corrections, is_put_anew

CONFIG = CorrectionConfig()
PERIOD = 1 / 120


@pytest.mark.parametrize("error", [[0.002, -0.001, 0.0, 0.0, 0.0, 0.01], [0.0, 0.02, 0.0, 0.1, 0.0, 0.0]])
def test_a_small_error_is_corrected_by_the_gains(error: list[float]) -> None:
    errors = np.array([error])
    shifts, twists = corrections(errors, np.array([PERIOD]), CONFIG)
    assert np.allclose(shifts, CONFIG.pose_gain * errors)
    assert np.allclose(twists, CONFIG.twist_gain / PERIOD * errors)


@pytest.mark.parametrize(("way", "period"), [(0.001, np.inf), (1.01 * CONFIG.jump, PERIOD), (1.0, np.inf)])
def test_an_object_is_put_anew_at_first_sight_and_after_a_jump(way: float, period: float) -> None:
    errors, periods = np.array([[way, 0.0, 0.0, 0.0, 0.0, 0.1]]), np.array([period])
    shifts, twists = corrections(errors, periods, CONFIG)
    assert is_put_anew(errors, periods, CONFIG).all()
    assert np.array_equal(shifts, errors)
    assert not twists.any()


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_a_jump_is_a_distance_and_no_turn(axis: int) -> None:
    rows = np.zeros((2, 6))
    rows[0, axis], rows[1, 3 + axis] = 0.99 * CONFIG.jump, 3.0
    assert not is_put_anew(rows, np.full(2, PERIOD), CONFIG).any()


@pytest.mark.parametrize("period", [0.0, 1.01 * CONFIG.max_period])
def test_sights_too_far_apart_or_at_once_tell_no_velocity(period: float) -> None:
    _, twists = corrections(np.full((1, 6), 0.001), np.array([period]), CONFIG)
    assert not twists.any()
