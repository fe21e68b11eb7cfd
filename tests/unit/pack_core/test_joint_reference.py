"""A reference between its rows."""

import numpy as np
import pytest

from pack_core.joints import JointReference

PERIOD = 0.004


def cubic_motion(t: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """q, v, a `(T, 2)` of two cubics."""
    q = np.stack([1.0 + 2.0 * t - 3.0 * t**2 + 5.0 * t**3, -(t**3)], axis=1)
    v = np.stack([2.0 - 6.0 * t + 15.0 * t**2, -3.0 * t**2], axis=1)
    a = np.stack([-6.0 + 30.0 * t, -6.0 * t], axis=1)
    return q, v, a


@pytest.fixture
def reference() -> JointReference:
    offsets = np.arange(6) * PERIOD
    return JointReference(10.0, offsets, *cubic_motion(offsets))


def test_a_cubic_motion_is_met_exactly_between_the_rows(reference: JointReference) -> None:
    for t in np.linspace(0.0, 0.02, 47):
        for got, wanted in zip(reference.at(10.0 + t), cubic_motion(np.array([t])), strict=True):
            np.testing.assert_allclose(got, wanted[0], rtol=1e-9, atol=1e-9)


def test_the_velocity_is_the_derivative_of_the_position(reference: JointReference) -> None:
    h = 1e-6
    for t in (10.0005, 10.0031, 10.013):
        slope = (reference.at(t + h)[0] - reference.at(t - h)[0]) / (2 * h)
        np.testing.assert_allclose(reference.at(t)[1], slope, atol=1e-6)


def test_it_is_held_beyond_its_ends(reference: JointReference) -> None:
    np.testing.assert_array_equal(reference.at(9.0)[0], reference.q[0])
    np.testing.assert_array_equal(reference.at(reference.end + 1.0)[0], reference.q[-1])


def test_one_row_is_enough() -> None:
    row = np.ones((1, 6))
    single = JointReference(0.0, np.zeros(1), row, row, row)
    assert single.end == 0.0
    np.testing.assert_array_equal(single.at(0.002)[0], row[0])


def test_what_is_handed_out_is_a_copy(reference: JointReference) -> None:
    reference.at(10.0)[0][:] = 9.0
    assert reference.q[0, 0] == 1.0
