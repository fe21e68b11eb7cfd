"""Spheres that fill the arm and the box in its hand, and the distance of points to boxes."""

from __future__ import annotations

from itertools import product
from typing import NamedTuple

import numba
import numpy as np
import numpy.typing as npt

from pack_core.motion.world import CarriedBox
from pack_core.rotations import Array
from pack_motion.arm.arm import MotionArm


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


CORNER_RADIUS = 0.01
"""Of the spheres in and on a carried box [m]: small, so that the box is felt little larger than it is."""


class Spheres(NamedTuple):
    """Spheres fixed to links, given where all joints are zero.

    Attributes:
        link: index of the joint that moves it `(k,)`.
        p: centre in the world `(k, 3)` [m].
        radius: `(k,)` [m].
    """

    link: npt.NDArray[np.int64]
    p: Array
    radius: Array

    def with_carried(self, arm: MotionArm, carried: CarriedBox | None) -> Spheres:
        """These, and spheres in the corners and upright edges and amid the faces of the carried box."""
        if carried is None:
            return self
        chain, half = arm.chain, 0.5 * carried.size
        signs = [s for s in product((-1, 0, 1), repeat=3) if sum(map(abs, s)) in (1, 3)]
        signs += [(a, b, 0) for a, b in product((-1, 1), repeat=2)]
        p_B = np.array(signs) * (half - CORNER_RADIUS)
        p_T = carried.X_TB.apply(p_B)
        p = chain.p_WT + p_T @ chain.R_WT.T
        link = np.full(len(p), chain.n - 1, dtype=np.int64)
        radius = np.full(len(p), CORNER_RADIUS)
        return Spheres(
            np.concatenate([self.link, link]), np.vstack([self.p, p]), np.concatenate([self.radius, radius])
        )


def arm_spheres(arm: MotionArm, first_link: int) -> Spheres:
    """Spheres along the longest axis of every box of the arm from a link on, as wide as its middle edge."""
    bodies, links, centres, radii = arm.bodies, [], [], []
    for i in range(len(bodies)):
        if bodies.link[i] < first_link:
            continue
        order = np.argsort(bodies.half[i])
        radius, reach = float(bodies.half[i][order[1]]), float(bodies.half[i][order[2]])
        n = max(int(np.ceil(reach / radius)), 1)
        for s in np.linspace(-1.0, 1.0, n) if n > 1 else (0.0,):
            links.append(bodies.link[i])
            centres.append(bodies.p[i] + s * (reach - radius) * bodies.R[i][:, order[2]])
            radii.append(radius)
    return Spheres(np.array(links, dtype=np.int64), np.array(centres), np.array(radii))
