"""Rotations are a group, and every form of one says the same."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pack_core.rotations import (
    IDENTITY,
    Array,
    Pose,
    angle_between,
    conjugate,
    exp,
    from_matrix,
    from_yaw,
    log,
    multiply,
    normalize,
    rotate,
    tilts,
    to_matrix,
    yaw_of,
)

coordinates = st.floats(-2.0, 2.0)
points = st.tuples(coordinates, coordinates, coordinates).map(np.array)
quaternions = (
    st.tuples(*[st.floats(-1.0, 1.0)] * 4)
    .map(np.array)
    .filter(lambda q: np.linalg.norm(q) > 0.1)
    .map(normalize)
)
poses = st.builds(Pose, points, quaternions)


def is_same_rotation(q_1: Array, q_2: Array) -> bool:
    """Equal up to the sign, which means nothing."""
    return bool(np.isclose(abs(np.dot(q_1, q_2)), 1.0, atol=1e-9))


@given(quaternions, quaternions, points)
def test_one_and_an_array_of_one_are_reckoned_with_alike(q: Array, r: Array, p: Array) -> None:
    for single, several in (
        (multiply(q, r), multiply(q[None], r)), (rotate(q, p), rotate(q[None], p)),
        (exp(p), exp(p[None])), (log(q), log(q[None])), (normalize(3.0 * q), normalize(3.0 * q[None])),
    ):  # fmt: skip
        np.testing.assert_allclose(single, several[0], rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_what_is_not_finite_gives_nan_instead_of_an_error(value: float) -> None:
    assert np.isnan(exp([value, 0.0, 0.0])).all()
    assert np.isnan(multiply([value, 0.0, 0.0, 0.0], IDENTITY)).any()


@given(quaternions, quaternions, quaternions)
def test_multiplication_is_associative(a: Array, b: Array, c: Array) -> None:
    np.testing.assert_allclose(multiply(multiply(a, b), c), multiply(a, multiply(b, c)), atol=1e-12)


@given(quaternions)
def test_identity_changes_nothing_and_the_conjugate_undoes(q: Array) -> None:
    np.testing.assert_allclose(multiply(q, IDENTITY), q, atol=1e-12)
    np.testing.assert_allclose(multiply(q, conjugate(q)), IDENTITY, atol=1e-12)


@given(quaternions, quaternions, points)
def test_rotating_twice_equals_rotating_by_the_product(a: Array, b: Array, p: Array) -> None:
    np.testing.assert_allclose(rotate(multiply(a, b), p), rotate(a, rotate(b, p)), atol=1e-9)


@given(quaternions, points)
def test_a_rotation_keeps_lengths_and_equals_its_matrix(q: Array, p: Array) -> None:
    assert np.linalg.norm(rotate(q, p)) == pytest.approx(np.linalg.norm(p), abs=1e-9)
    np.testing.assert_allclose(to_matrix(q) @ p, rotate(q, p), atol=1e-9)


@given(quaternions)
def test_matrices_are_orthogonal_with_determinant_one(q: Array) -> None:
    np.testing.assert_allclose(to_matrix(q) @ to_matrix(q).T, np.eye(3), atol=1e-12)
    assert np.linalg.det(to_matrix(q)) == pytest.approx(1.0)


@given(quaternions)
def test_matrix_and_back_gives_the_same_rotation(q: Array) -> None:
    assert is_same_rotation(from_matrix(to_matrix(q)), q)


@pytest.mark.parametrize("axis", np.eye(3))
def test_half_turns_survive_the_matrix(axis: Array) -> None:
    q = exp(np.pi * axis)
    assert is_same_rotation(from_matrix(to_matrix(q)), q)


@given(quaternions)
def test_exp_undoes_log(q: Array) -> None:
    assert is_same_rotation(exp(log(q)), q)


@given(points.filter(lambda v: np.linalg.norm(v) < 3.1))
def test_log_undoes_exp(rotation_vector: Array) -> None:
    np.testing.assert_allclose(log(exp(rotation_vector)), rotation_vector, atol=1e-7)


@given(st.floats(-3.1, 3.1), st.floats(-3.0, 3.0))
def test_yaws_add_up(a: float, b: float) -> None:
    turn = (yaw_of(multiply(from_yaw(a), from_yaw(b))) - a - b) / (2 * np.pi)
    assert turn == pytest.approx(round(turn), abs=1e-9)


@given(st.floats(-3.1, 3.1), st.floats(0.0, 3.1))
def test_a_tilt_leans_the_z_axis_to_its_side_by_its_length(side: float, tilt: float) -> None:
    towards = np.array([np.cos(side), np.sin(side)])
    axis = rotate(exp(tilts(tilt * towards[None])[0]), [0.0, 0.0, 1.0])
    np.testing.assert_allclose(axis, [*(np.sin(tilt) * towards), np.cos(tilt)], atol=1e-12)


@given(quaternions, st.floats(0.0, 3.1))
def test_angle_between_is_the_turn_that_was_made(q: Array, angle: float) -> None:
    turned = multiply(q, exp(angle * np.array([0.6, 0.0, 0.8])))
    assert angle_between(q, turned) == pytest.approx(angle, abs=1e-7)


@given(poses, poses, poses)
def test_poses_compose_associatively(X_AB: Pose, X_BC: Pose, X_CD: Pose) -> None:
    left, right = (X_AB @ X_BC) @ X_CD, X_AB @ (X_BC @ X_CD)
    np.testing.assert_allclose(left.p, right.p, atol=1e-9)
    assert is_same_rotation(left.q, right.q)


@given(poses, points)
def test_the_inverse_pose_brings_points_back(X_AB: Pose, p_B: Array) -> None:
    np.testing.assert_allclose(X_AB.inverse().apply(X_AB.apply(p_B)), p_B, atol=1e-9)


@given(poses, poses, points)
def test_applying_a_composition_equals_applying_its_parts(X_AB: Pose, X_BC: Pose, p_C: Array) -> None:
    np.testing.assert_allclose((X_AB @ X_BC).apply(p_C), X_AB.apply(X_BC.apply(p_C)), atol=1e-9)


def test_a_pose_cannot_be_changed_in_place() -> None:
    p = np.zeros(3)
    X_WB = Pose(p)
    p[0] = 1.0
    assert X_WB.p[0] == 0.0
    with pytest.raises(ValueError, match="read-only"):
        X_WB.p[0] = 1.0
