"""Finds the straight edges of a box with sub-pixel accuracy: one near a line, or the four of a top face."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from pydantic import Field, PositiveFloat

from pack_core.camera import Picture, PinholeCamera
from pack_core.config import Config
from pack_core.rotations import Array

FADE = 2.0
"""Width over which the window around a slope fades out [pixel]."""


class EdgeConfig(Config):
    """Parameters of the edge search; lengths in pixels of the top face."""

    reach: PositiveFloat = Field(10.0, description="how far from where it is supposed an edge is searched")
    step: PositiveFloat = Field(0.25, description="between the samples of a profile across an edge")
    core: PositiveFloat = Field(2.5, description="half width of the slope whose middle is the edge")
    ends: float = Field(0.08, ge=0, lt=0.4, description="share of an edge that is left out at either end")
    max_residual: PositiveFloat = Field(0.75, description="points further from the line do not count")


@dataclass(frozen=True)
class EdgeLine:
    """A line on the plane of the top face.

    Attributes:
        middle: the point in the middle of the edge `(2,)` in the world [m].
        direction: unit vector along the line `(2,)`.
        length: length of the edge along which it was searched [m].
        inliers: share of the profiles whose slope lies on the line.
        contrast: median over the profiles of how much brighter the box is than its surroundings, of 255; for
            a dark box, how much darker.
        inside: median over the profiles of the brightness just inside the edge.
    """

    middle: Array
    direction: Array
    length: float
    inliers: float
    contrast: float
    inside: float


@dataclass(frozen=True)
class TopFace:
    """The picture seen as a map of the plane of the top face.

    Attributes:
        value: brightness of a region of the picture `(h, w)`.
        corner: column and row of that region in the camera's picture `(2,)`.
        camera: the camera that took the picture.
        height: height of the plane in the world [m].
        is_dark: whether the box is darker than its surroundings.
    """

    value: Picture
    corner: tuple[int, int]
    camera: PinholeCamera
    height: float
    is_dark: bool

    @property
    def pixel(self) -> float:
        """Width of a pixel on the plane [m]."""
        return float(self.camera.X_WC.p[2] - self.height) / self.camera.f

    def brightness(self, points: Array) -> Array:
        """Brightness at points `(..., 2)` [m] of the plane, interpolated bilinearly."""
        p_W = np.concatenate([points, np.full((*points.shape[:-1], 1), self.height)], axis=-1)
        uv = (self.camera.project(p_W) - self.corner).astype(np.float32)
        rows = uv.reshape(len(uv), -1, 2)
        sampled = cv2.remap(
            self.value, rows[..., 0], rows[..., 1], cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE
        )
        return np.asarray(sampled, dtype=float).reshape(points.shape[:-1])


def find_edge(face: TopFace, start: Array, end: Array, config: EdgeConfig) -> EdgeLine | None:
    """The edge near the line from `start` to `end` `(2,)` [m], the box to its left; None where there is none.

    Profiles of brightness are sampled across the line, one for each pixel along it. The edge in a profile is
    the centroid of its steepest slope, and a line is fitted to these points without the outliers.
    """
    length = float(np.linalg.norm(end - start))
    along = (end - start) / length
    outward = np.array([along[1], -along[0]])
    places = np.arange(config.ends * length, (1.0 - config.ends) * length, face.pixel)
    across = np.arange(-config.reach, config.reach + config.step, config.step)
    points = start + places[:, None, None] * along + across[:, None] * face.pixel * outward
    profiles = face.brightness(points)
    slopes = np.gradient(profiles, config.step, axis=1) * (1.0 if face.is_dark else -1.0)
    offsets = _slope_middles(slopes, across, config.core)
    slant, shift, is_on = _robust_line(places / face.pixel, offsets, config.max_residual)
    if is_on.sum() < 10:  # too few profiles for a line
        return None
    direction = along + slant * outward
    middle_place = 0.5 * length / face.pixel
    inside, contrast = _levels(profiles[is_on], offsets[is_on], across, config.core)
    return EdgeLine(
        start + 0.5 * length * along + (slant * middle_place + shift) * face.pixel * outward,
        direction / np.linalg.norm(direction), length, float(is_on.mean()),
        -contrast if face.is_dark else contrast, inside,
    )  # fmt: skip


def _slope_middles(slopes: Array, across: Array, core: float) -> Array:
    """Centroid of each profile's steepest slope `(n,)` [pixel].

    The window about it fades out, so that it moves evenly with an edge that crosses the pixels slowly.
    """
    peaks = across[np.argmax(slopes, axis=1)]
    for _ in range(3):  # again around the centroid, so that the window is even to both sides of it
        window = np.clip((core - np.abs(across - peaks[:, None])) / FADE + 0.5, 0.0, 1.0)
        weights = np.clip(slopes, 0.0, None) * window
        totals = weights.sum(axis=1)
        peaks = np.where(totals > 0.0, weights @ across / np.where(totals > 0.0, totals, 1.0), np.nan)
    return np.asarray(peaks)


def _robust_line(places: Array, offsets: Array, max_residual: float) -> tuple[float, float, np.ndarray]:
    """Slant and shift of offsets = slant * places + shift, and which points lie on that line `(n,)`.

    The first line is the median of the offsets, without slant. It is fitted again and again to the points
    near the last line, while the limit of what counts as near shrinks to `max_residual`.
    """
    slant, shift = 0.0, float(np.nanmedian(offsets)) if np.any(np.isfinite(offsets)) else np.nan
    is_on = np.zeros(len(places), dtype=bool)
    for limit in (8.0, 4.0, 2.0, 1.0, 1.0):
        is_on = np.abs(offsets - slant * places - shift) <= limit * max_residual
        if is_on.sum() < 10:
            return slant, shift, np.zeros(len(places), dtype=bool)
        slant, shift = (float(value) for value in np.polyfit(places[is_on], offsets[is_on], 1))
    return slant, shift, is_on


def _levels(profiles: Array, offsets: Array, across: Array, core: float) -> tuple[float, float]:
    """Brightness just inside the edge, and its excess over that just outside; medians over the profiles."""
    distance = across - offsets[:, None]
    sides = [(distance < -core) & (distance > -2 * core), (distance > core) & (distance < 2 * core)]
    inside, outside = (np.sum(profiles * side, axis=1) / np.maximum(side.sum(axis=1), 1) for side in sides)
    return float(np.median(inside)), float(np.median(inside - outside))


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
