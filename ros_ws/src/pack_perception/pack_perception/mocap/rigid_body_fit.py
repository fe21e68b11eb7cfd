"""Poses of rigid bodies from their visible markers: least squares on SE(3).

Points alone are Kabsch's problem; points and directions are Wahba's. Where the markers do not match the body,
one or two of them may be false or confused with others: they are left out if there is exactly one way to
leave out so few and the rest matches.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import Enum
from itertools import combinations

import mujoco
import numpy as np
import numpy.typing as npt
from pydantic import Field, PositiveFloat

from pack_core.config import Config
from pack_core.rotations import Array

Mask = npt.NDArray[np.bool_]


@dataclass(frozen=True)
class Alignment:
    """Least-squares poses of k bodies B.

    Attributes:
        p_WB: origins `(k, 3)` [m].
        q_WB: orientations `(k, 4)`, wxyz.
        spread: rms distances `(k,)` [m] of the markers from the line that fits them best.
        residual: rms distances `(k,)` [m] of the markers from where the poses put them.
    """

    p_WB: Array
    q_WB: Array
    spread: Array
    residual: Array


def align(p_BM: Array, p_WM: Array, visible: Mask, pulls: Array | float = 0.0) -> Alignment:
    """Align bodies with their markers: Kabsch's solution with Umeyama's guard against reflections.

    Args:
        p_BM: where the m markers are on each of the k bodies `(k, m, 3)` [m].
        p_WM: where they were measured `(k, m, 3)` [m].
        visible: which of them were measured `(k, m)`.
        pulls: outer products `v_W v_B^T` `(k, 3, 3)` [m^2] of directions that are to agree as well, their
            lengths being their weights.
    """
    weights = visible.astype(float)[:, :, None]
    n = np.maximum(weights.sum(axis=1), 1.0)
    centre_B, centre_W = (p_BM * weights).sum(axis=1) / n, (p_WM * weights).sum(axis=1) / n
    from_B, from_W = (p_BM - centre_B[:, None]) * weights, (p_WM - centre_W[:, None]) * weights
    # the rotation that maximises trace(R^T H) for H = sum of w_W w_B^T is U V^T of the SVD of H
    U, moments, Vt = np.linalg.svd(from_W.transpose(0, 2, 1) @ from_B + pulls)
    # a negative determinant is a reflection: turn over the direction of the smallest singular value
    U[np.linalg.det(U @ Vt) < 0.0, :, 2] *= -1.0
    R_WB = U @ Vt
    misses = from_B @ R_WB.transpose(0, 2, 1) - from_W
    residual = np.sqrt((misses**2).sum(axis=(1, 2)) / n[:, 0])
    p_WB = centre_W - (R_WB @ centre_B[:, :, None])[:, :, 0]
    # singular values are sums of squares along the principal directions: the second measures the spread
    # of the markers away from the line along the first
    return Alignment(p_WB, _quaternions(R_WB), np.sqrt(moments[:, 1] / n[:, 0]), residual)


def _quaternions(R: Array) -> Array:
    quaternions = np.empty((len(R), 4))
    for q, matrix in zip(quaternions, R, strict=True):
        mujoco.mju_mat2Quat(q, matrix.ravel())
    return quaternions


AGREEING = 4
"""Markers that must match the body where others are left out: three can do so turned over."""


class FitConfig(Config):
    """Conditions under which a fit is accepted."""

    min_markers: int = Field(default=3, ge=3, description="visible markers")
    min_spread: PositiveFloat = Field(
        default=0.008, description="rms distance of the markers from the line that fits them best [m]"
    )
    max_residual: PositiveFloat = Field(default=0.003, description="rms distance of a marker [m]")
    max_left_out: int = Field(default=2, ge=0, description="markers that may be false")


class FitRefusal(Enum):
    """Reasons to refuse a fit."""

    TOO_FEW = "too few markers"
    COLLINEAR = "markers on a line"
    RESIDUAL = "markers do not match the object"
    NOT_STANDING = "markers not as high as those of the standing object"


@dataclass(frozen=True)
class Fits:
    """Fitted poses of k bodies B; refused rows must not be used.

    Attributes:
        p_WB: origins `(k, 3)` [m].
        q_WB: orientations `(k, 4)`, wxyz.
        residual: rms distance `(k,)` [m] of the markers from where the pose puts them.
        refusals: why a fit was refused; None where it was accepted.
        left_out: number of markers that were not used because they do not match `(k,)`.
    """

    p_WB: Array
    q_WB: Array
    residual: Array
    refusals: tuple[FitRefusal | None, ...]
    left_out: npt.NDArray[np.int_]


def fit_rigid_bodies(p_BM: Array, p_WM: Array, visible: Mask, config: FitConfig) -> Fits:
    """Fit poses of k bodies to their markers by least squares.

    Args:
        p_BM: where the m markers are on each of the k bodies `(k, m, 3)` [m].
        p_WM: where they were measured `(k, m, 3)` [m].
        visible: which of them were measured `(k, m)`.
        config: conditions under which a fit is accepted.
    """
    whole = _fit(p_BM, p_WM, visible, config)
    used = visible.copy()
    for row in np.flatnonzero(whole.residual > config.max_residual):
        used[row] = _matching(p_BM[row], p_WM[row], visible[row], config)
    left_out = visible.sum(axis=1) - used.sum(axis=1)
    fits = _fit(p_BM, p_WM, used, config) if left_out.any() else whole
    return replace(fits, left_out=left_out)


def _matching(p_BM: Array, p_WM: Array, visible: Mask, config: FitConfig) -> Mask:
    """The visible markers of one body `(m,)` without those that do not match; all where that is not clear."""
    there = np.flatnonzero(visible)
    for count in range(1, min(config.max_left_out, len(there) - AGREEING) + 1):
        used = np.array([visible & ~np.isin(np.arange(len(visible)), some)
                         for some in combinations(there, count)])  # fmt: skip
        n = len(used)
        fits = _fit(np.repeat(p_BM[None], n, axis=0), np.repeat(p_WM[None], n, axis=0), used, config)
        matching = [row for row, refusal in enumerate(fits.refusals) if refusal is None]
        if matching:
            return used[matching[0]] if len(matching) == 1 else visible
    return visible


def _fit(p_BM: Array, p_WM: Array, visible: Mask, config: FitConfig) -> Fits:
    """Poses from all visible markers."""
    found = align(p_BM, p_WM, visible)
    refusals = tuple(
        FitRefusal.TOO_FEW if count < config.min_markers
        else FitRefusal.COLLINEAR if width < config.min_spread
        else FitRefusal.RESIDUAL if miss > config.max_residual
        else None
        for count, width, miss in zip(visible.sum(axis=1), found.spread, found.residual, strict=True)
    )  # fmt: skip
    none = np.zeros(len(refusals), dtype=int)
    return Fits(found.p_WB, found.q_WB, found.residual, refusals, none)
