from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import lsq_linear

from pack_core.rotations import Array, exp, to_matrix
from pack_motion.clearance.separation import separation

vectors = st.lists(st.floats(-1.5, 1.5), min_size=3, max_size=3).map(np.array)
turns = vectors.map(lambda v: np.ascontiguousarray(to_matrix(exp(v))))  # laid out as the check has them
sizes = st.lists(st.floats(0.05, 0.5), min_size=3, max_size=3).map(np.array)


def distance(R_a: Array, p_a: Array, half_a: Array, R_b: Array, p_b: Array, half_b: Array) -> float:
    """Between two boxes, as a bounded least-squares problem over a point of each."""
    A = np.hstack([R_a * half_a, -R_b * half_b])
    return float(np.sqrt(2.0 * lsq_linear(A, p_b - p_a, (-1.0, 1.0)).cost))


@given(p=vectors, R_a=turns, R_b=turns, half_a=sizes, half_b=sizes)
@settings(max_examples=100)
def test_the_gap_is_at_most_the_distance_and_positive_where_there_is_one(
    p: Array, R_a: Array, R_b: Array, half_a: Array, half_b: Array
) -> None:
    boxes = R_a, np.zeros(3), half_a, R_b, p, half_b
    gap, true = separation(*boxes, np.inf), distance(*boxes)
    assert gap <= true + 1e-6
    if true > 1e-3:
        assert gap > 0.0
        assert gap >= 0.5 * true
    assert gap == pytest.approx(separation(*boxes[3:], *boxes[:3], np.inf), abs=1e-12)


@pytest.mark.parametrize(("x", "gap"), [(0.25, 0.05), (0.15, -0.05)])
def test_boxes_face_to_face_are_as_far_apart_as_they_are(x: float, gap: float) -> None:
    one, other = np.zeros(3), np.array([x, 0.05, 0.0])
    half = np.full(3, 0.1)
    assert separation(np.eye(3), one, half, np.eye(3), other, half, np.inf) == pytest.approx(gap)


@given(p=vectors, R_a=turns, R_b=turns, half_a=sizes, half_b=sizes, enough=st.floats(0.001, 1.0))
@settings(max_examples=100)
def test_a_gap_is_exact_up_to_what_is_enough(
    p: Array, R_a: Array, R_b: Array, half_a: Array, half_b: Array, enough: float
) -> None:
    boxes = R_a, np.zeros(3), half_a, R_b, p, half_b
    assert separation(*boxes, enough) == min(separation(*boxes, np.inf), enough)
