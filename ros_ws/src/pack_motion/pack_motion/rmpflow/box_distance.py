"""Signed distance from a point to a box, and how it changes."""

from __future__ import annotations

import numba
import numpy as np

from pack_core.rotations import Array


@numba.njit(cache=True)
def box_distance(p: Array, R: Array, centre: Array, half: Array) -> tuple[float, Array]:
    """Signed distance of `p (3,)` to a box, negative inside, and its gradient `(3,)`, in the world."""
    local = R.T @ (p - centre)
    w = np.abs(local) - half
    outside = np.maximum(w, 0.0)
    d = np.sqrt(outside @ outside)
    side = np.where(local < 0.0, -1.0, 1.0)
    if d > 0.0:
        return float(d), R @ (side * outside / d)
    k = np.argmax(w)
    g = np.zeros(3)
    g[k] = side[k]
    return float(w[k]), R @ g


@numba.njit(cache=True)
def distance_curvature(p: Array, v: Array, R: Array, centre: Array, half: Array) -> float:
    """Second derivative [m/s^2] of the distance for a point that moves evenly at `v` relative to the box."""
    local, rate = R.T @ (p - centre), R.T @ v
    w = np.abs(local) - half
    outside = np.maximum(w, 0.0)
    d = np.sqrt(outside @ outside)
    if d < 1e-6:
        return 0.0
    across = np.where(w > 0.0, rate, 0.0)
    along = (np.where(local < 0.0, -1.0, 1.0) * outside / d) @ rate
    return float((across @ across - along * along) / d)
