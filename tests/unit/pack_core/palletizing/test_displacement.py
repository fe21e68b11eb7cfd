"""Things that stand elsewhere than the configuration has them."""

import numpy as np
import pytest

from pack_core.palletizing.cell import palletizing_cell
from pack_core.palletizing.imperfections import NOWHERE, Displacement
from pack_core.rotations import Pose, angle_between, from_yaw


def test_a_thing_that_is_not_displaced_keeps_its_pose_exactly() -> None:
    X_WF = Pose(np.array([0.1, 0.2, 0.3]), from_yaw(0.4))
    assert NOWHERE.applied(X_WF, [1.0, 2.0, 3.0]) is X_WF


def test_a_turn_leaves_the_middle_where_the_shift_puts_it() -> None:
    moved = Displacement.of([0.003, -0.002, 0.001, 0.0, 0.0, np.pi / 2])
    middle = np.array([1.0, 2.0, 0.7])
    np.testing.assert_allclose(moved.about(middle).apply(middle), middle + np.array([0.003, -0.002, 0.001]))
    beside = moved.about(middle).apply(middle + np.array([1.0, 0.0, 0.0]))
    np.testing.assert_allclose(beside, middle + np.array([0.003, 1.0 - 0.002, 0.001]), atol=1e-12)


def test_a_displaced_pallet_takes_its_frame_with_it() -> None:
    pallet = palletizing_cell().pallet
    shifted = pallet.model_copy(update={"displacement": Displacement.of([0.003, 0.0, 0.001, 0.0, 0.0, 0.01])})
    middle_P = np.array([*pallet.size, 0.0]) / 2
    np.testing.assert_allclose(shifted.X_WP.apply(middle_P), pallet.middle + np.array([0.003, 0.0, 0.001]))
    assert angle_between(pallet.X_WP.q, shifted.X_WP.q) == pytest.approx(0.01)


def test_shift_and_turn_survive_as_a_vector() -> None:
    vector = np.array([0.001, 0.002, 0.003, 0.004, 0.005, 0.006])
    np.testing.assert_array_equal(Displacement.of(vector).vector, vector)


def test_the_displacement_between_two_poses_is_the_one_that_was_applied() -> None:
    given = Displacement.of([0.003, -0.002, 0.001, 0.002, -0.003, 0.004])
    middle, X_WF = np.array([1.0, 2.0, 0.7]), Pose(np.array([0.4, 1.5, 0.7]), from_yaw(0.3))
    found = Displacement.between(X_WF, given.applied(X_WF, middle), middle)
    np.testing.assert_allclose(found.vector, given.vector, atol=1e-12)
