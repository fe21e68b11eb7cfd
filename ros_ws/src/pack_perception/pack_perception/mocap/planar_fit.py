"""Where bodies are in the plane, from too few markers for a free fit: height and tilt are taken as expected.

What stands in a container has a known height and no tilt, and what physics carries has those that physics
predicts. Two markers are four equations in the plane for the three unknowns x, y and yaw, and their heights
tell whether the body is as high and as tilted as expected.

With noise sigma of a coordinate, and S the sum of the markers' squared distances from their centre as seen
from above, the yaw has the deviation sigma / sqrt(S): for two markers at distance b, sigma * sqrt(2) / b. A
point of the body at distance r from the centre of n markers has sigma * sqrt(1 / n + r^2 / S) across the line
to it.

A tilt that is not expected shows in the heights of the markers, save where they are right above the edge that
the body turns about.
"""

from __future__ import annotations

import numpy as np
from pydantic import Field, PositiveFloat

from pack_core.config import Config
from pack_core.rotations import Array, exp, multiply, rotate
from pack_perception.mocap.rigid_body_fit import Fits, Mask, Refusal


class PlanarFitConfig(Config):
    """What a fit in the plane needs to be believed."""

    min_markers: int = Field(default=2, ge=2, description="visible markers")
    min_spread: PositiveFloat = Field(
        default=0.01, description="rms distance of the markers from their centre, seen from above [m]"
    )
    max_residual: PositiveFloat = Field(
        default=0.003, description="rms distance of a marker, in the plane and in height together [m]"
    )


def fit_in_plane(p_BM: Array, p_WM: Array, visible: Mask, expected: Array, config: PlanarFitConfig) -> Fits:
    """Fit x, y and yaw to markers, by least squares; height and tilt stay as expected.

    Args:
        p_BM: where the m markers are on each of the k bodies `(k, m, 3)` [m].
        p_WM: where they were measured `(k, m, 3)` [m].
        visible: which of them were `(k, m)`.
        expected: poses `(k, 7)` whose heights and tilts are right; place and yaw are not used.
        config: what a fit needs to be believed.
    """
    weights = visible.astype(float)[:, :, None]
    counts = weights.sum(axis=(1, 2))
    n = np.maximum(counts, 1.0)
    p_EM = rotate(expected[:, None, 3:], p_BM)
    centre_E, centre_W = (p_EM * weights).sum(axis=1) / n[:, None], (p_WM * weights).sum(axis=1) / n[:, None]
    (xs_E, ys_E), (xs_W, ys_W) = (
        np.moveaxis((p - centre[:, None])[:, :, :2] * weights, 2, 0)
        for p, centre in ((p_EM, centre_E), (p_WM, centre_W))
    )
    spread = np.sqrt((xs_E**2 + ys_E**2).sum(axis=1) / n)
    yaws = np.arctan2((xs_E * ys_W - ys_E * xs_W).sum(axis=1), (xs_E * xs_W + ys_E * ys_W).sum(axis=1))
    turns = exp(yaws[:, None] * np.array([0.0, 0.0, 1.0]))
    p_WB = centre_W - rotate(turns, centre_E)
    p_WB[:, 2] = expected[:, 2]
    misses = (p_WB[:, None] + rotate(turns[:, None], p_EM) - p_WM) * weights
    residual = np.sqrt((misses**2).sum(axis=(1, 2)) / n)
    return Fits(p_WB, multiply(turns, expected[:, 3:]), residual, _refusals(counts, spread, residual, config))


def _refusals(
    counts: Array, spread: Array, residual: Array, config: PlanarFitConfig
) -> tuple[Refusal | None, ...]:
    first_that_holds = [
        Refusal.TOO_FEW if count < config.min_markers
        else Refusal.TOO_CLOSE if width < config.min_spread
        else Refusal.UNEXPECTED if miss > config.max_residual
        else None
        for count, width, miss in zip(counts, spread, residual, strict=True)
    ]  # fmt: skip
    return tuple(first_that_holds)
