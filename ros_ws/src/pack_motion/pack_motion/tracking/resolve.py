"""Resolves the summed policies (metric M, force f) into joint accelerations."""

from __future__ import annotations

import mujoco
import numpy as np

from pack_core.rotations import Array

PSEUDO_INVERSE_CUTOFF = 1e-8
"""Eigenvalues of M below this share of the largest count as zero."""


def resolve_within(M: Array, f: Array, lower: Array, upper: Array) -> Array:
    """Accelerations `(n,)` that minimise `a^T M a / 2 - f^T a` within bounds: a box-constrained QP."""
    n = len(f)
    scale = n / float(np.trace(M))  # makes the mean eigenvalue of M 1, and leaves the minimum where it is
    a = np.clip(np.zeros(n), lower, upper)
    factor, index = np.zeros((n, n + 7)), np.zeros(n, dtype=np.int32)  # workspace of mju_boxQP, n x (n + 7)
    mujoco.mju_boxQP(a, factor, index, scale * M, -scale * f, lower, upper)
    return a


def resolve_capped(M: Array, f: Array, norm: float) -> Array:
    """`M^+ f`, scaled down to a largest norm [rad/s^2]: the resolve of RMPflow, which has no joint limits."""
    a = np.linalg.pinv(M, rcond=PSEUDO_INVERSE_CUTOFF, hermitian=True) @ f
    size = float(np.linalg.norm(a))
    return np.asarray(a if size <= norm else a * (norm / size))
