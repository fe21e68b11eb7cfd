"""Poses from too few markers for a free fit, with the direction of the body's axis taken from physics.

Two markers fix five of a body's six coordinates. The sixth, the rotation about the line through both,
follows from the direction of the body's z axis: up for a standing body, and as predicted for one that physics
carries. A direction is one more pair of vectors in Kabsch's problem, which then is Wahba's ("A Least Squares
Estimate of Satellite Attitude").

Let sigma be the standard deviation of a coordinate and S the sum of the markers' squared distances from their
centre, seen along the axis. Then the yaw has the standard deviation sigma / sqrt(S); for two markers at
distance b that is sigma * sqrt(2) / b. Of a tilt along their line the markers determine the share
S / (S + arm^2), of a tilt about that line nothing.
"""

from __future__ import annotations

import numpy as np
from pydantic import Field, PositiveFloat

from pack_core.config import Config
from pack_core.rotations import Array, rotate
from pack_perception.mocap.alignment import Mask, align
from pack_perception.mocap.rigid_body_fit import FitRefusal, Fits

Z = np.array([0.0, 0.0, 1.0])
STANDING_ARM = 1.0
"""Arm of a standing body's axis, so long that markers hardly tilt it [m]."""


class AxisFitConfig(Config):
    """Conditions under which a fit with the axis is accepted."""

    min_markers: int = Field(default=2, ge=2, description="visible markers")
    min_spread: PositiveFloat = Field(
        default=0.01, description="rms distance of the markers from their centre, seen along the axis [m]"
    )
    max_residual: PositiveFloat = Field(default=0.003, description="rms distance of a marker [m]")
    arm: PositiveFloat = Field(
        default=0.01,
        description="where up the axis a marker would tell its direction as well as physics predicts it [m]",
    )


def fit_with_axis(
    p_BM: Array, p_WM: Array, visible: Mask, expected: Array, is_known: Mask, config: AxisFitConfig
) -> Fits:
    """Fit poses to markers and to the directions in which the z axes are expected.

    Args:
        p_BM: where the m markers are on each of the k bodies `(k, m, 3)` [m].
        p_WM: where they were measured `(k, m, 3)` [m].
        visible: which of them were measured `(k, m)`.
        expected: expected poses `(k, 7)`; their z axes are used.
        is_known: bodies `(k,)` whose expected pose comes from earlier fits. The others are taken to stand as
            expected, and are refused if their markers are not at the height that follows.
        config: conditions under which a fit is accepted.
    """
    arms, axes = np.where(is_known, config.arm, STANDING_ARM), rotate(expected[:, 3:], Z)
    # a unit vector scaled by the arm counts like a marker that far up the axis: arm^2 z_W z_B^T
    found = align(p_BM, p_WM, visible, (arms**2)[:, None, None] * axes[:, :, None] * Z)
    # how much higher the markers are than those of the expected pose
    lifts = p_WM[:, :, 2] - expected[:, None, 2] - rotate(expected[:, None, 3:], p_BM)[:, :, 2]
    refusals = tuple(
        FitRefusal.TOO_FEW if count < config.min_markers
        else FitRefusal.COLLINEAR if width < config.min_spread
        else FitRefusal.NOT_STANDING if not known and lift > config.max_residual
        else FitRefusal.RESIDUAL if miss > config.max_residual
        else None
        for count, width, known, lift, miss in zip(
            visible.sum(axis=1), _rms_from_centre(p_BM[:, :, :2], visible), is_known,
            _rms(lifts[:, :, None], visible), found.residual, strict=True,
        )
    )  # fmt: skip
    none = np.zeros(len(refusals), dtype=int)
    return Fits(found.p_WB, found.q_WB, found.residual, refusals, none)


def _rms(vectors: Array, visible: Mask) -> Array:
    """Root of the mean square length `(k,)` of the visible ones of `(k, m, d)`."""
    squares = (vectors**2).sum(axis=2) * visible
    return np.asarray(np.sqrt(squares.sum(axis=1) / np.maximum(visible.sum(axis=1), 1)))


def _rms_from_centre(points: Array, visible: Mask) -> Array:
    """Root of the mean square distance `(k,)` of the visible ones of `(k, m, d)` from their centre."""
    n = np.maximum(visible.sum(axis=1), 1)[:, None]
    centres = (points * visible[:, :, None]).sum(axis=1) / n
    return _rms(points - centres[:, None], visible)
