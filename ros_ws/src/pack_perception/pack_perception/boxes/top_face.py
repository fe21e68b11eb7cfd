"""The pose of a box's top face from its four edges.

The camera sees the side of a box below an edge that lies between the box and the camera's foot, so that the
outline there may be the edge of the top or that of the base. The other edges hide their side: they are the
top face's own. A pose comes from those alone, with the known size where only one of two opposite edges is
sure; the doubtful ones serve to check the size.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pack_core.rotations import Array
from pack_perception.boxes.edge_line import EdgeLine

HIDDEN = 1e-4
"""A side that sticks out by less cannot be told from the edge above it [m]."""


@dataclass(frozen=True)
class Viewpoint:
    """Where the camera is as seen from the plane of the top face.

    Attributes:
        foot: point of the plane below the camera `(2,)` in the world [m].
        slope: how far the base of a side sticks out in the picture, on the plane of the top face, for every
            metre between the edge above it and the foot.
    """

    foot: Array
    slope: float


@dataclass(frozen=True)
class Span:
    """The top face along one of its axes.

    Attributes:
        middle: coordinate of its middle along the axis [m].
        measured: distance of the two edges [m].
        mismatch: how much it differs from what it should be [m].
        is_sure: for the edges at the lower and at the upper end: it is the top face's own.
    """

    middle: float
    measured: float
    mismatch: float
    is_sure: tuple[bool, bool]


@dataclass(frozen=True)
class TopPose:
    """A hypothesis about the top face.

    Attributes:
        yaw: of the side d_x [rad], in (-pi/2, pi/2].
        centre: `(2,)` in the world [m].
        size: as measured along d_x and d_y [m].
        mismatch: the larger of the two of the spans [m].
        sure: indices of the edges that it rests on.
    """

    yaw: float
    centre: Array
    size: tuple[float, float]
    mismatch: float
    sure: tuple[int, ...]


def measure_span(low: float, high: float, expected: float, foot: float, slope: float) -> Span:
    """A span between edges at `low` and `high`, with the camera's foot at `foot` on the axis [m]."""
    measured = high - low
    beyond_high = (foot - low - expected) * slope
    beyond_low = (high - expected - foot) * slope
    visible = max(beyond_high, beyond_low)
    if visible < HIDDEN:
        return Span(0.5 * (low + high), measured, abs(measured - expected), (True, True))
    mismatch = min(abs(measured - expected), abs(measured - expected - visible))
    if beyond_high > beyond_low:
        return Span(low + 0.5 * expected, measured, mismatch, (True, False))
    return Span(high - 0.5 * expected, measured, mismatch, (False, True))


def top_poses(edges: Sequence[EdgeLine], dims: tuple[float, float], view: Viewpoint) -> list[TopPose]:
    """The two hypotheses: d_x along the first edge, or along the second.

    Args:
        edges: four, counter-clockwise as seen from above.
        dims: d_x and d_y [m].
        view: where the camera is.
    """
    return [_hypothesis(edges, first, dims, view) for first in (0, 1)]


def _hypothesis(edges: Sequence[EdgeLine], first: int, dims: tuple[float, float], view: Viewpoint) -> TopPose:
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
    """Along d_x, between the edges that lead across it, and along d_y; and which edges are sure."""
    axes, spans, sure = _axes(yaw), [], []
    for axis, expected, one in zip(axes, dims, (first + 1, first), strict=True):
        ends = sorted((float(axis @ edges[k % 4].middle), k % 4) for k in (one, one + 2))
        (low, low_edge), (high, high_edge) = ends
        span = measure_span(low, high, expected, float(axis @ view.foot), view.slope)
        spans.append(span)
        sure += [edge for edge, is_sure in zip((low_edge, high_edge), span.is_sure, strict=True) if is_sure]
    return spans, tuple(sorted(sure))


def _mean_direction(edges: Sequence[EdgeLine], first: int, which: Sequence[int]) -> float:
    """Yaw of the first edge by all of `which`, each turned onto it [rad]; long edges tell it better."""
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
