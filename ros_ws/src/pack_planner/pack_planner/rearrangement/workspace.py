"""The convex polygon in which blocks may be put down."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from pack_core.blocks.problem import Point
from pack_core.rotations import Array

SLACK = 1e-9
"""Poses on the very edge are inside [m]."""


def edges(corners: Sequence[Point]) -> Array:
    """Half planes `(edges, 3)`: a point p is inside where `n @ p <= d`, rows n_x, n_y, d."""
    points = np.array(corners, dtype=float)
    along = np.roll(points, -1, axis=0) - points
    normals = np.stack([along[:, 1], -along[:, 0]], axis=1) * np.sign(signed_area(corners))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return np.column_stack([normals, np.sum(normals * points, axis=1)])


def signed_area(corners: Sequence[Point]) -> float:
    """Area [m^2] of a polygon, positive when its corners run counter-clockwise."""
    x, y = np.array(corners, dtype=float).T
    return float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y) / 2)


def is_convex(corners: Sequence[Point]) -> bool:
    """At least three corners, all on or inside every edge, and an area."""
    points = np.array(corners, dtype=float)
    if (
        len(points) < 3
        or np.all(points == np.roll(points, 1, axis=0), axis=1).any()
        or abs(signed_area(corners)) < 1e-9
    ):
        return False
    half_planes = edges(corners)
    return bool(np.all(half_planes[:, :2] @ points.T <= half_planes[:, 2:] + SLACK))


def corners_of(poses: Array, side: float) -> Array:
    """Corners `(..., 4, 2)` of blocks at poses `(..., 3)`."""
    signs = np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]]) * side / 2
    cosine, sine = np.cos(poses[..., 2, None]), np.sin(poses[..., 2, None])
    x = poses[..., 0, None] + cosine * signs[:, 0] - sine * signs[:, 1]
    y = poses[..., 1, None] + sine * signs[:, 0] + cosine * signs[:, 1]
    return np.stack([x, y], axis=-1)


def are_inside(poses: Array, side: float, half_planes: Array) -> npt.NDArray[np.bool_]:
    """Blocks at poses `(..., 3)` stand inside with all corners `(...)`."""
    heights = corners_of(poses, side) @ half_planes[:, :2].T
    return np.asarray(np.all(heights <= half_planes[:, 2] + SLACK, axis=(-2, -1)))
