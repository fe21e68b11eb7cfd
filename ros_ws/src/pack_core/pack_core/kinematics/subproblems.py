"""Paden-Kahan subproblems, compiled: angles that bring points where they should be.

Murray, Li, Sastry, "A mathematical introduction to robotic manipulation", section 3.3; the numbering
is that of Elias and Wen, "IK-Geo: unified robot inverse kinematics using subproblem decomposition".
R(k, angle) is the rotation about the unit vector k.
"""

from __future__ import annotations

import numba
import numpy as np

from pack_core.kinematics.screws import cross
from pack_core.rotations import Array

ROUNDING = 1e-9
"""How far a cosine may be beyond 1 and still count as 1."""


@numba.njit(cache=True)
def angle_about(k: Array, a: Array, b: Array) -> float:
    """Subproblem 1: the angle about `k` that turns `a` towards `b`; 0 where either is along `k`."""
    # Of the parts of a and b across k, |a'| |b'| times sine and cosine of the angle between them.
    sine = k @ cross(a, b)
    cosine = a @ b - (k @ a) * (k @ b)
    if sine * sine + cosine * cosine < 1e-24:  # |a'| |b'| < 1e-12: rounding alone would choose the angle
        return 0.0
    return float(np.arctan2(sine, cosine))


@numba.njit(cache=True)
def angles_to_plane(k: Array, h: Array, a: Array, level: float) -> Array:
    """Subproblem 4: both angles `(2,)` about `k` that give the turned `a` the component `level` along `h`.

    The component rises with the angle at the first and falls at the second; NaN where no angle does.
    """
    # Rodrigues: h . R(k, t) a = (h . k)(k . a) + x cos t + y sin t, where the last two terms are
    # radius cos(t - middle).
    x = h @ a - (h @ k) * (k @ a)
    y = h @ cross(k, a)
    radius = np.hypot(x, y)
    if radius < 1e-12:
        return np.full(2, np.nan)
    cosine = (level - (h @ k) * (k @ a)) / radius
    if abs(cosine) > 1.0 + ROUNDING:
        return np.full(2, np.nan)
    half = np.arccos(max(-1.0, min(1.0, float(cosine))))
    middle = np.arctan2(y, x)
    return np.array([middle - half, middle + half])


@numba.njit(cache=True)
def angles_to_distance(k: Array, a: Array, b: Array, distance: float) -> Array:
    """Subproblem 3: both angles `(2,)` about `k` that bring the turned `a` to a distance from `b`."""
    # |R a - b|^2 = a . a + b . b - 2 b . R a, so that subproblem 4 gives the angle.
    level = 0.5 * (a @ a + b @ b - distance * distance)
    return np.asarray(angles_to_plane(k, b, a, float(level)))
