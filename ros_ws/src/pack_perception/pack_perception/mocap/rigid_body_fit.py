"""Poses of rigid bodies from their visible markers: least squares on SE(3)."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

import mujoco
import numpy as np
import numpy.typing as npt
from pydantic import Field, PositiveFloat

from pack_core.config import Config
from pack_core.rotations import Array

Mask = npt.NDArray[np.bool_]


class FitConfig(Config):
    """What a fit needs to be believed."""

    min_markers: int = Field(default=3, ge=3, description="visible markers")
    min_spread: PositiveFloat = Field(
        default=0.008, description="rms distance of the markers from the line that fits them best [m]"
    )
    max_residual: PositiveFloat = Field(default=0.003, description="rms distance of a marker [m]")


class Refusal(Enum):
    """Why there is no fit."""

    TOO_FEW = "too few markers"
    COLLINEAR = "markers on a line"
    RESIDUAL = "markers do not match the object"
    TOO_CLOSE = "markers too close together to tell a yaw"
    UNEXPECTED = "markers not where an object of this height and tilt has them"


@dataclass(frozen=True)
class Fits:
    """Fitted poses of k bodies B; rows that were refused are not to be used.

    Attributes:
        p_WB: origins `(k, 3)` [m].
        q_WB: orientations `(k, 4)`, wxyz.
        residual: rms distance `(k,)` [m] of the markers from where the pose puts them.
        refusals: why there is no fit, None where there is one.
    """

    p_WB: Array
    q_WB: Array
    residual: Array
    refusals: tuple[Refusal | None, ...]


def fit_rigid_bodies(p_BM: Array, p_WM: Array, visible: Mask, config: FitConfig) -> Fits:
    """Fit poses to markers: Kabsch's solution with Umeyama's guard against reflections.

    Args:
        p_BM: where the m markers are on each of the k bodies `(k, m, 3)` [m].
        p_WM: where they were measured `(k, m, 3)` [m].
        visible: which of them were `(k, m)`.
        config: what a fit needs to be believed.
    """
    weights = visible.astype(float)[:, :, None]
    counts = weights.sum(axis=1)
    n = np.maximum(counts, 1.0)
    centre_B, centre_W = (p_BM * weights).sum(axis=1) / n, (p_WM * weights).sum(axis=1) / n
    from_B, from_W = (p_BM - centre_B[:, None]) * weights, (p_WM - centre_W[:, None]) * weights
    U, spread, Vt = np.linalg.svd(from_W.transpose(0, 2, 1) @ from_B)
    U[np.linalg.det(U @ Vt) < 0.0, :, 2] *= -1.0
    R_WB = U @ Vt
    misses = from_B @ R_WB.transpose(0, 2, 1) - from_W
    residual = np.sqrt((misses**2).sum(axis=(1, 2)) / n[:, 0])
    refusals = _refusals(counts[:, 0], np.sqrt(spread[:, 1] / n[:, 0]), residual, config)
    return Fits(centre_W - (R_WB @ centre_B[:, :, None])[:, :, 0], _quaternions(R_WB), residual, refusals)


def _refusals(counts: Array, spread: Array, residual: Array, config: FitConfig) -> tuple[Refusal | None, ...]:
    first_that_holds = [
        Refusal.TOO_FEW if count < config.min_markers
        else Refusal.COLLINEAR if width < config.min_spread
        else Refusal.RESIDUAL if miss > config.max_residual
        else None
        for count, width, miss in zip(counts, spread, residual, strict=True)
    ]  # fmt: skip
    return tuple(first_that_holds)


def _quaternions(R: Array) -> Array:
    quaternions = np.empty((len(R), 4))
    for q, matrix in zip(quaternions, R, strict=True):
        mujoco.mju_mat2Quat(q, matrix.ravel())
    return quaternions
