"""What is compiled for rows of poses is what `rotations` says of each."""

from __future__ import annotations

import numpy as np
import pytest

from pack_core.rotations import Array, conjugate, exp, from_yaw, log, multiply, rotate
from pack_perception.mocap.pose_rows import pose_errors, shift, shifted, turned

RNG = np.random.default_rng(0)


def poses(n: int) -> Array:
    return np.hstack([RNG.normal(size=(n, 3)), exp(RNG.normal(size=(n, 3)))])


def test_an_error_is_the_way_from_the_expected_to_the_seen_pose() -> None:
    seen = np.array([[0.1, 0.0, 0.0, *from_yaw(0.3)]])
    expected = np.array([[0.0, 0.2, 0.0, *from_yaw(-0.1)]])
    assert np.allclose(pose_errors(seen, expected), [[0.1, -0.2, 0.0, 0.0, 0.0, 0.4]])


def test_errors_turn_the_shorter_way_whatever_the_quaternions_signs() -> None:
    seen, expected = poses(20), poses(20)
    errors = pose_errors(seen, expected)
    np.testing.assert_allclose(errors[:, :3], seen[:, :3] - expected[:, :3])
    turns = log(multiply(seen[:, 3:], conjugate(expected[:, 3:])))
    np.testing.assert_allclose(errors[:, 3:], turns, atol=1e-12)
    seen[::2, 3:] *= -1.0
    np.testing.assert_allclose(pose_errors(seen, expected), errors, atol=1e-12)


def test_a_pose_shifted_by_its_error_is_the_pose_seen() -> None:
    seen, expected = poses(20), poses(20)
    found = shifted(expected, pose_errors(seen, expected))
    assert np.abs(pose_errors(seen, found)).max() < 1e-12


@pytest.mark.parametrize("times", [0, 1, 5])
def test_a_shift_moves_its_objects_at_all_times_and_nothing_else(times: int) -> None:
    qpos = RNG.normal(size=(times, 30))
    addresses = np.array([np.arange(3, 10), np.arange(20, 27)])
    qpos[:, addresses] = poses(2 * times).reshape(times, 2, 7)
    before, shifts = qpos.copy(), RNG.normal(size=(2, 6))
    shift(qpos, addresses, shifts)
    for row, old in zip(qpos, before, strict=True):
        np.testing.assert_allclose(row[addresses], shifted(old[addresses], shifts))
    others = np.setdiff1d(np.arange(30), addresses)
    np.testing.assert_array_equal(qpos[:, others], before[:, others])


def test_twists_turn_from_body_axes_into_the_worlds_and_back() -> None:
    rows, twists = poses(10), RNG.normal(size=(10, 6))
    found = turned(rows, twists, False)
    np.testing.assert_array_equal(found[:, :3], twists[:, :3])
    np.testing.assert_allclose(found[:, 3:], rotate(rows[:, 3:], twists[:, 3:]))
    np.testing.assert_allclose(turned(rows, found, True), twists)


def test_no_rows_are_no_rows() -> None:
    assert pose_errors(np.zeros((0, 7)), np.zeros((0, 7))).shape == (0, 6)
    assert turned(np.zeros((0, 7)), np.zeros((0, 6)), False).shape == (0, 6)
