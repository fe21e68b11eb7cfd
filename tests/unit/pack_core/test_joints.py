"""Setpoints between their rows."""

import numpy as np
import pytest

from pack_core.errors import PackError
from pack_core.joints import JointSample, Setpoints, hold

PERIOD = 0.004


def cubic_motion(t: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """q, v, a `(T, 2)` of two cubics."""
    q = np.stack([1.0 + 2.0 * t - 3.0 * t**2 + 5.0 * t**3, -(t**3)], axis=1)
    v = np.stack([2.0 - 6.0 * t + 15.0 * t**2, -3.0 * t**2], axis=1)
    a = np.stack([-6.0 + 30.0 * t, -6.0 * t], axis=1)
    return q, v, a


@pytest.fixture
def setpoints() -> Setpoints:
    offsets = np.arange(6) * PERIOD
    q, v, a = cubic_motion(offsets)
    return Setpoints(10.0, offsets, q, v, a=a)


def test_a_cubic_motion_is_met_exactly_between_the_rows(setpoints: Setpoints) -> None:
    for t in np.linspace(0.0, 0.02, 47):
        for got, wanted in zip(setpoints.at(10.0 + t), cubic_motion(np.array([t])), strict=True):
            np.testing.assert_allclose(got, wanted[0], rtol=1e-9, atol=1e-9)


def test_the_velocity_is_the_derivative_of_the_position(setpoints: Setpoints) -> None:
    h = 1e-6
    for t in (10.0005, 10.0031, 10.013):
        slope = (setpoints.at(t + h)[0] - setpoints.at(t - h)[0]) / (2 * h)
        np.testing.assert_allclose(setpoints.at(t)[1], slope, atol=1e-6)


def test_it_is_held_beyond_its_ends(setpoints: Setpoints) -> None:
    np.testing.assert_array_equal(setpoints.at(9.0)[0], setpoints.q[0])
    np.testing.assert_array_equal(setpoints.at(setpoints.end + 1.0)[0], setpoints.q[-1])


def test_one_row_is_enough() -> None:
    row = np.ones((1, 6))
    single = Setpoints(0.0, np.zeros(1), row, row, a=row)
    assert single.end == 0.0
    np.testing.assert_array_equal(single.at(0.002)[0], row[0])


def test_what_is_handed_out_is_a_copy(setpoints: Setpoints) -> None:
    setpoints.at(10.0)[0][:] = 9.0
    assert setpoints.q[0, 0] == 1.0


def test_rows_with_torques_are_joined_by_straight_lines_and_held_beyond_their_ends() -> None:
    rows = np.array([[0.0], [1.0], [5.0]])
    plan = Setpoints(2.0, np.array([0.0, 0.1, 0.3]), rows, 10.0 * rows, 100.0 * rows)
    for time, expected in (
        (1.0, 0.0),
        (2.0, 0.0),
        (2.05, 0.5),
        (2.1, 1.0),
        (2.2, 3.0),
        (2.3, 5.0),
        (9.0, 5.0),
    ):
        np.testing.assert_allclose(plan.at(time), np.array([[1.0], [10.0], [100.0]]) * expected)


@pytest.mark.parametrize("stated", [{}, {"a": np.zeros((1, 2)), "tau": np.zeros((1, 2))}])
def test_setpoints_state_either_torques_or_accelerations(stated: dict[str, np.ndarray]) -> None:
    with pytest.raises(PackError, match="torques or accelerations"):
        Setpoints(0.0, np.zeros(1), np.zeros((1, 2)), np.zeros((1, 2)), **stated)


def test_only_the_first_rows_are_kept_up_to_an_offset(setpoints: Setpoints) -> None:
    kept = setpoints.until(2.5 * PERIOD)
    assert len(kept.offsets) == 3
    np.testing.assert_array_equal(kept.fed_forward, setpoints.fed_forward[:3])


@pytest.mark.parametrize("offset", [0.0, 0.9 * PERIOD, PERIOD, 3.5 * PERIOD, 5 * PERIOD, 1.0])
def test_what_is_kept_is_what_was_stated(setpoints: Setpoints, offset: float) -> None:
    with_torques = Setpoints(10.0, setpoints.offsets, setpoints.q, setpoints.v, setpoints.q**2)
    n = int((setpoints.offsets <= offset).sum())
    for whole in (setpoints, with_torques):
        kept = whole.until(offset)
        assert kept.time == whole.time
        for name in ("offsets", "q", "v", "tau", "a"):
            np.testing.assert_array_equal(
                getattr(kept, name), None if getattr(whole, name) is None else getattr(whole, name)[:n]
            )


def test_setpoints_that_hold_run_out_at_once_and_ask_for_no_motion() -> None:
    sample = JointSample(3.0, np.arange(6.0), np.ones(6), np.ones(6))
    held = hold(sample)
    assert held.end == held.time == 3.0
    q, v, tau = held.at(9.0)
    np.testing.assert_array_equal(q, sample.q)
    assert not v.any()
    assert not tau.any()
