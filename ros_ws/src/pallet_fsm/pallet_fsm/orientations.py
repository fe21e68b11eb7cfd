"""The orientations that a box may have at its place."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import permutations, product

import numpy as np

from pack_core.rotations import Array, Pose, from_matrix, rotate

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
