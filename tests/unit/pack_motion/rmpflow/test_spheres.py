from __future__ import annotations

import numpy as np
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from pack_core.rotations import Array, exp, to_matrix
from pack_motion.rmpflow.spheres import box_distance, distance_curvature

vectors = st.lists(st.floats(-1.0, 1.0), min_size=3, max_size=3).map(np.array)
CENTRE, HALF = np.array([0.1, -0.2, 0.3]), np.array([0.3, 0.2, 0.1])
R = np.ascontiguousarray(to_matrix(exp(np.array([0.3, -0.5, 0.8]))))  # as the policies have it
H = 1e-5


def distance(p: Array) -> float:
    return float(box_distance(p, R, CENTRE, HALF)[0])


@given(p=vectors)
@settings(max_examples=60)
def test_gradient_is_the_derivative_of_the_distance(p: Array) -> None:
    local = np.sort(np.abs(np.abs(R.T @ (p - CENTRE)) - HALF))
    assume(local[0] > 1e-3 and np.diff(local).min() > 1e-3)
    gradient = box_distance(p, R, CENTRE, HALF)[1]
    slopes = [(distance(p + H * e) - distance(p - H * e)) / (2 * H) for e in np.eye(3)]
    np.testing.assert_allclose(gradient, slopes, atol=1e-4)
    assert np.isclose(np.linalg.norm(gradient), 1.0)


@given(p=vectors, v=vectors)
@settings(max_examples=60)
def test_curvature_is_the_second_derivative_along_a_straight_way(p: Array, v: Array) -> None:
    w = np.abs(R.T @ (p - CENTRE)) - HALF
    assume(np.abs(w).min() > 1e-2 and w.max() > 2e-2)
    h = 1e-4
    bend = (distance(p + h * v) - 2.0 * distance(p) + distance(p - h * v)) / h**2
    assert np.isclose(distance_curvature(p, v, R, CENTRE, HALF), bend, atol=1e-3)


def test_inside_the_distance_is_that_to_the_nearest_face() -> None:
    d, g = box_distance(CENTRE + R @ np.array([0.25, 0.0, 0.0]), R, CENTRE, HALF)
    assert np.isclose(d, -0.05)
    np.testing.assert_allclose(g, R[:, 0], atol=1e-12)
