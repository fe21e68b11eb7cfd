"""The pose of a box's top face from its four edges.

The camera sees a side of the box where the edge above it lies between the box and the camera's foot, so that
the outline there may be the edge of the top face or that of the base. The other sides are hidden: there the
outline is the edge of the top face. The pose comes from these sure edges alone, with the known size where
only one of two opposite edges is sure; the doubtful edges serve to check the size.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pack_core.rotations import Array
from pack_perception.boxes.edge_line import EdgeLine

HIDDEN = 1e-4
"""A side that is visible by less than this cannot be told from the edge above it [m]."""


@dataclass(frozen=True)
class Viewpoint:
    """The camera's position relative to the plane of the top face.

    Attributes:
        foot: point of the plane below the camera `(2,)` in the world [m].
        slope: ratio of the visible width of a side, projected to the plane of the top face, to the distance
            of the edge above it from the foot.
    """

    foot: Array
    slope: float


@dataclass(frozen=True)
class Span:
    """The top face along one of its axes.

    Attributes:
        middle: coordinate of the middle of the face along the axis [m].
        measured: distance of the two edges [m].
        mismatch: difference between the measured and the expected distance [m].
        is_sure: whether the edge at the lower and that at the upper end are edges of the top face.
    """

    middle: float
    measured: float
    mismatch: float
    is_sure: tuple[bool, bool]


@dataclass(frozen=True)
class TopPose:
    """A hypothesis about the pose of the top face.

    Attributes:
        yaw: yaw of the side d_x [rad], in (-pi/2, pi/2].
        centre: centre of the face `(2,)` in the world [m].
        size: measured size along d_x and d_y [m].
        mismatch: the larger mismatch of the two spans [m].
        sure: indices of the edges that the pose is computed from.
    """

    yaw: float
    centre: Array
    size: tuple[float, float]
    mismatch: float
    sure: tuple[int, ...]


def measure_span(low: float, high: float, expected: float, foot: float, slope: float) -> Span:
    """The span between edges at `low` and `high` along an axis, with the camera's foot at `foot` [m]."""
    measured = high - low
    # How wide the side beyond each edge is in the picture, if the opposite edge is the top face's own.
    beyond_high = (foot - low - expected) * slope
    beyond_low = (high - expected - foot) * slope
    visible = max(beyond_high, beyond_low)
    if visible < HIDDEN:
        return Span(0.5 * (low + high), measured, abs(measured - expected), (True, True))
    # The doubtful edge may be that of the top face or that of the base: whichever fits the size better.
    mismatch = min(abs(measured - expected), abs(measured - expected - visible))
    if beyond_high > beyond_low:
        return Span(low + 0.5 * expected, measured, mismatch, (True, False))
    return Span(high - 0.5 * expected, measured, mismatch, (False, True))


def top_poses(edges: Sequence[EdgeLine], dims: tuple[float, float], view: Viewpoint) -> list[TopPose]:
    """The two hypotheses: d_x along the first edge, or along the second.

    Args:
        edges: the four edges, counter-clockwise as seen from above.
        dims: expected d_x and d_y [m].
        view: position of the camera.
    """
    return [_hypothesis(edges, first, dims, view) for first in (0, 1)]


def _hypothesis(edges: Sequence[EdgeLine], first: int, dims: tuple[float, float], view: Viewpoint) -> TopPose:
    # All edges give a first yaw, by which the sure edges are known; these alone give the final one.
    yaw = _mean_direction(edges, first, range(4))
    spans, sure = _spans(edges, first, yaw, dims, view)
    yaw = _mean_direction(edges, first, sure)
    spans, sure = _spans(edges, first, yaw, dims, view)
    axes = _axes(yaw)
    centre = axes.T @ np.array([span.middle for span in spans])
    mismatch = max(span.mismatch for span in spans)
    size = (spans[0].measured, spans[1].measured)
    return TopPose(_folded(yaw), centre, size, mismatch, sure)


def _spans(
    edges: Sequence[EdgeLine], first: int, yaw: float, dims: tuple[float, float], view: Viewpoint
) -> tuple[list[Span], tuple[int, ...]]:
    """The spans along d_x and along d_y, and the indices of the sure edges.

    The span along d_x is between the two edges across it, and that along d_y between the other two.
    """
    axes, spans, sure = _axes(yaw), [], []
    for axis, expected, one in zip(axes, dims, (first + 1, first), strict=True):
        ends = sorted((float(axis @ edges[k % 4].middle), k % 4) for k in (one, one + 2))
        (low, low_edge), (high, high_edge) = ends
        span = measure_span(low, high, expected, float(axis @ view.foot), view.slope)
        spans.append(span)
        sure += [edge for edge, is_sure in zip((low_edge, high_edge), span.is_sure, strict=True) if is_sure]
    return spans, tuple(sorted(sure))


def _mean_direction(edges: Sequence[EdgeLine], first: int, which: Sequence[int]) -> float:
    """Weighted mean yaw [rad] of the edges `which`, each turned by quarter turns onto the first one.

    The weight is the length cubed: the variance of the slope of a line fitted to evenly spaced points falls
    with the cube of its length.
    """
    start = np.arctan2(edges[first].direction[1], edges[first].direction[0])
    turns, weights = [], []
    for k in which:
        angle = np.arctan2(edges[k].direction[1], edges[k].direction[0]) - 0.5 * np.pi * (k - first)
        turns.append((angle - start + np.pi) % (2 * np.pi) - np.pi)
        weights.append(edges[k].length ** 3)
    return float(start + np.average(turns, weights=weights))


def _axes(yaw: float) -> Array:
    """Unit vectors of the top face, along and across, in rows."""
    return np.array([[np.cos(yaw), np.sin(yaw)], [-np.sin(yaw), np.cos(yaw)]])


def _folded(yaw: float) -> float:
    """The equivalent yaw in (-pi/2, pi/2]."""
    return float(0.5 * np.pi - (0.5 * np.pi - yaw) % np.pi)
