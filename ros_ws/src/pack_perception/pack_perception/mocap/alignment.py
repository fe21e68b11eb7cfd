"""Poses that align points (Kabsch's problem), and directions as well (Wahba's problem)."""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np
import numpy.typing as npt

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
