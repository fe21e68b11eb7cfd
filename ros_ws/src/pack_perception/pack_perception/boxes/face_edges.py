"""Finds the four edges of a top face, starting from a rough rectangle."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np

from pack_core.rotations import Array
from pack_perception.boxes.edge_line import EdgeConfig, EdgeLine, TopFace, find_edge


def rough_corners(outline: Array, face: TopFace) -> Array:
    """Corners `(4, 2)` [m] of the smallest rectangle around an outline, counter-clockwise from above."""
    pixels = cv2.boxPoints(cv2.minAreaRect(outline.astype(np.float32))) + np.array(face.corner)
    corners = face.camera.at_height(pixels, face.height)[:, :2]
    (x_0, y_0), (x_1, y_1) = corners[1] - corners[0], corners[2] - corners[1]
    # A negative cross product of two consecutive sides: the corners are clockwise.
    return corners[::-1] if x_0 * y_1 < y_0 * x_1 else corners


def find_edges(face: TopFace, corners: Array, config: EdgeConfig) -> list[EdgeLine | None]:
    """The edges near the sides of a rectangle with corners `(4, 2)` [m]; None where none is found."""
    return [find_edge(face, corners[k], corners[(k + 1) % 4], config) for k in range(4)]


def corners_of(edges: Sequence[EdgeLine]) -> Array:
    """The corners `(4, 2)` [m] of four edges: where each edge meets the one before it."""
    return np.array([_meeting(edges[k - 1], edges[k]) for k in range(4)])


def _meeting(first: EdgeLine, second: EdgeLine) -> Array:
    """The intersection of two lines `(2,)` [m]."""
    A = np.stack([first.direction, -second.direction], axis=1)
    along = np.linalg.solve(A, second.middle - first.middle)[0]
    return np.asarray(first.middle + along * first.direction)
