"""Poses of rigid bodies from their visible markers: least squares on SE(3)."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from pydantic import Field, PositiveFloat

from pack_core.config import Config
from pack_core.rotations import Array
from pack_perception.mocap.alignment import Mask, align


class FitConfig(Config):
    """Conditions under which a fit is accepted."""

    min_markers: int = Field(default=3, ge=3, description="visible markers")
    min_spread: PositiveFloat = Field(
        default=0.008, description="rms distance of the markers from the line that fits them best [m]"
    )
    max_residual: PositiveFloat = Field(default=0.003, description="rms distance of a marker [m]")


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
    """

    p_WB: Array
    q_WB: Array
    residual: Array
    refusals: tuple[FitRefusal | None, ...]


def fit_rigid_bodies(p_BM: Array, p_WM: Array, visible: Mask, config: FitConfig) -> Fits:
    """Fit poses of k bodies to their markers by least squares.

    Args:
        p_BM: where the m markers are on each of the k bodies `(k, m, 3)` [m].
        p_WM: where they were measured `(k, m, 3)` [m].
        visible: which of them were measured `(k, m)`.
        config: conditions under which a fit is accepted.
    """
    found = align(p_BM, p_WM, visible)
    refusals = tuple(
        FitRefusal.TOO_FEW if count < config.min_markers
        else FitRefusal.COLLINEAR if width < config.min_spread
        else FitRefusal.RESIDUAL if miss > config.max_residual
        else None
        for count, width, miss in zip(visible.sum(axis=1), found.spread, found.residual, strict=True)
    )  # fmt: skip
    return Fits(found.p_WB, found.q_WB, found.residual, refusals)
