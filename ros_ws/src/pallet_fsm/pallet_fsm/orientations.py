"""The orientations that a box may have at its place, sorted by how far the arm must turn to reach them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import permutations, product

import numpy as np

from pack_core.rotations import Array, Pose, angle_between, conjugate, from_matrix, from_yaw, multiply, rotate

EQUAL = 1e-6
"""Edges that differ by less count as equal [m]."""
ALONG = 0.9
"""Cosine from which two directions count as the same; those compared are quarter turns apart."""


def _signed_permutations() -> tuple[Array, ...]:
    """The 24 proper rotations of a cube, each `(3, 3)`."""
    matrices = (
        np.eye(3)[list(order)] * np.array(signs)[:, None]
        for order in permutations(range(3))
        for signs in product((1.0, -1.0), repeat=3)
    )
    return tuple(matrix for matrix in matrices if np.linalg.det(matrix) > 0.0)  # -1: with a reflection


CUBE = _signed_permutations()


def box_orientations(dims: Sequence[float], extents: Sequence[float | None]) -> list[Array]:
    """Orientations q_WB, wxyz, in which a box with edges `dims` [m] has given extents along the world's axes.

    Args:
        dims: edges of the box along its own axes [m].
        extents: wanted extent along each axis of the world [m]; None: any.
    """
    found = []
    for R_WB in CUBE:
        edges = np.abs(R_WB) @ np.asarray(dims)
        if all(want is None or abs(edge - want) < EQUAL for edge, want in zip(edges, extents, strict=True)):
            found.append(from_matrix(R_WB))
    return found


def points_along(X_WT: Pose, direction: Array) -> bool:
    """Whether the tool's approach axis z points along a unit vector of the world."""
    return float(rotate(X_WT.q, np.array([0.0, 0.0, 1.0])) @ direction) > ALONG


def by_turning(poses: Iterable[Pose], X_WT: Pose, p_WBase: Array) -> list[Pose]:
    """Sort tool poses by how far the wrist turns to them from X_WT, the arm's own heading left out.

    Args:
        poses: poses of the tool.
        X_WT: pose that the tool comes from.
        p_WBase: position of the arm's base `(3,)` [m].
    """
    q_from = _seen_from_arm(X_WT, p_WBase)
    return sorted(poses, key=lambda pose: float(angle_between(q_from, _seen_from_arm(pose, p_WBase))))


def _seen_from_arm(X_WT: Pose, p_WBase: Array) -> Array:
    """Orientation of the tool relative to the vertical plane through the arm's base and the tool, wxyz."""
    x, y = (X_WT.p - p_WBase)[:2]
    return multiply(conjugate(from_yaw(float(np.arctan2(y, x)))), X_WT.q)
