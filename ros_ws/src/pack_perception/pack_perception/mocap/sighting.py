"""Poses of objects from one frame: from their markers alone, or with an axis that physics predicts."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from pack_core.rotations import Array
from pack_perception.mocap.alignment import Mask
from pack_perception.mocap.axis_fit import AxisFitConfig, fit_with_axis
from pack_perception.mocap.rigid_body_fit import FitConfig, FitRefusal, fit_rigid_bodies

TOO_LITTLE = (FitRefusal.TOO_FEW, FitRefusal.COLLINEAR)
"""Refusals after which a fit with the expected axis is tried; mismatching markers are never used."""


@dataclass(frozen=True)
class MarkerSighting:
    """Measured poses of n objects; refused rows must not be used.

    Attributes:
        poses: X_WB as position and quaternion `(n, 7)`.
        is_partial: objects whose pose needed an expected axis beside its markers `(n,)`.
        refusals: why the markers gave no pose; None where they did.
        left_out: markers that were not used because they do not match the others `(n,)`.
    """

    poses: Array
    is_partial: Mask
    refusals: tuple[FitRefusal | None, ...]
    left_out: npt.NDArray[np.int_]

    @property
    def is_placed(self) -> Mask:
        """Objects that have a pose `(n,)`."""
        return np.array([refusal is None for refusal in self.refusals], dtype=bool)


def sight(
    p_BM: Array,
    p_WM: Array,
    visible: Mask,
    expected: Array,
    is_known: Mask,
    fit: FitConfig,
    axis: AxisFitConfig,
) -> MarkerSighting:
    """Fit every object freely, and with its expected axis where its markers are too few for that.

    Args:
        p_BM: where the m markers are on each of the n objects `(n, m, 3)` [m].
        p_WM: where they were measured `(n, m, 3)` [m].
        visible: which of them were measured `(n, m)`.
        expected: expected poses `(k, 7)` of the first k objects; the others are fitted freely or not at all.
        is_known: whether these come from earlier fits `(k,)`; the other objects are expected to stand.
        fit: conditions under which a free fit is accepted.
        axis: conditions under which a fit with the axis is accepted.
    """
    free = fit_rigid_bodies(p_BM, p_WM, visible, fit)
    poses, refusals = np.concatenate([free.p_WB, free.q_WB], axis=1), list(free.refusals)
    is_partial = np.zeros(len(poses), dtype=bool)
    rows = [i for i in range(len(expected)) if refusals[i] in TOO_LITTLE]
    if not rows:
        return MarkerSighting(poses, is_partial, tuple(refusals), free.left_out)
    led = fit_with_axis(p_BM[rows], p_WM[rows], visible[rows], expected[rows], is_known[rows], axis)
    poses[rows] = np.concatenate([led.p_WB, led.q_WB], axis=1)
    for i, refusal in zip(rows, led.refusals, strict=True):
        refusals[i], is_partial[i] = refusal, refusal is None
    return MarkerSighting(poses, is_partial, tuple(refusals), free.left_out)
