"""The top face of a box in a scan: where rays cross its plane, and where it lies by the rays that meet it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pack_core.motion.world import Obstacle
from pack_core.rotations import Array, to_matrix
from pack_perception.scans.rays import Rays

STRIP = 0.024
"""Width of the strips on both sides of an edge that must be seen for the edge to tell anything [m]."""
PIECE = 0.016
"""Length of the pieces of an edge that are looked at one by one [m]."""


@dataclass(frozen=True)
class BoxTop:
    """A rectangle F: the top of a box where it is expected, axes along its edges, z up.

    Attributes:
        p_WF: its middle `(3,)` [m].
        R_WF: its axes as columns `(3, 3)`.
        half: half its edges `(2,)` [m].
    """

    p_WF: Array
    R_WF: Array
    half: Array

    @classmethod
    def of(cls, box: Obstacle) -> BoxTop:
        """The top of a box, whichever of its sides that is."""
        R_WB = to_matrix(box.X_WO.q)
        vertical = int(np.argmax(np.abs(R_WB[2])))
        level = [(vertical + 1) % 3, (vertical + 2) % 3]
        up, x = np.sign(R_WB[2, vertical]) * R_WB[:, vertical], R_WB[:, level[0]]
        R_WF = np.column_stack([x, np.cross(up, x), up])
        return cls(box.X_WO.p + 0.5 * box.size[vertical] * up, R_WF, 0.5 * box.size[level])

    def crossings(self, rays: Rays) -> tuple[Array, Array]:
        """Where rays cross its plane, along its axes `(n, 2)` [m], and at which distance `(n,)` [m]."""
        start, way = (rays.p_W - self.p_WF) @ self.R_WF, rays.directions_W @ self.R_WF
        distances = -start[2] / way[:, 2]
        return start[:2] + distances[:, None] * way[:, :2], distances

    def shows_edge(self, points: Array) -> Array:
        """Which of some points `(n, 2)` [m] tell where the face ends `(n,)`.

        Near an edge only those count beside which others are seen across the edge: where a neighbour hides
        the other side, the face could go on for all that is seen.
        """
        shows = np.ones(len(points), dtype=bool)
        for axis in (0, 1):
            along = points[:, 1 - axis] + self.half[1 - axis]
            piece = np.floor(along / PIECE).astype(int)
            last = int(2.0 * self.half[1 - axis] / PIECE)
            for side in (-1.0, 1.0):
                depth = self.half[axis] - side * points[:, axis]
                is_beside = (np.abs(depth) < STRIP) & (piece >= 0) & (piece <= last)
                inner, outer = (
                    np.bincount(piece[is_beside & is_side], minlength=last + 1) > 0
                    for is_side in (depth > 0.0, depth <= 0.0)
                )
                shows[is_beside] &= (inner & outer)[piece[is_beside]]
        return shows


COARSE, FINE = (0.03, 0.012), 0.004
"""Widths of the edge in the fit [m]: those by which a face is found that was moved by centimetres, and the
last one, half of the rays' spacing, with which the rays beside an edge decide."""
BESIDE = 0.04
"""Rays farther from an edge than this tell nothing about a face that lies about where it should [m]."""
STEPS = 8
"""Newton steps with each width."""
LONGEST_STEP = np.array([0.03, 0.03, 0.15])
"""Of one Newton step [m, m, rad]."""
CLOSE = 2e-5
"""Newton's method ends when a step is smaller [m, rad]."""
PRIOR = np.array([0.05, 0.05, 0.5])
"""Standard deviations before anything is seen [m, m, rad], by which a shift that no ray tells of stays 0."""
OPEN = 0.005
"""Shifts along an axis in a range that is wider than this are all as likely [m]: its edges were not seen."""


@dataclass(frozen=True)
class FaceFit:
    """Shift and turn of a face.

    Attributes:
        shift: along its expected axes, and about the vertical `(3,)` [m, m, rad].
        sigma: of each `(3,)` [m, m, rad], about twice what repeated scans differ by; that of the prior where
            no ray tells anything.
    """

    shift: Array
    sigma: Array


def fit_face(points: Array, is_on: Array, half: Array, slack: float) -> FaceFit:
    """The rectangle that best parts points in those on it and those beside it.

    It is the logistic regression of `is_on` on the signed distance from the nearest edge, by Newton's method:
    a ray far from the edge counts nothing, one at the wrong side as much as it is far from it. Along an axis
    of which neighbours hide both edges a range of shifts is left; of those the least is taken.

    Args:
        points: where rays cross the plane `(n, 2)` [m].
        is_on: which of them meet the face `(n,)`.
        half: half the edges of the rectangle `(2,)` [m].
        slack: a face with no ray at the wrong side by more than this is about where it should be [m].
    """
    sign, shift = np.where(is_on, 1.0, -1.0), np.zeros(3)
    if np.any(sign * depths(points, half, shift) < -slack):
        for width in COARSE:
            shift = _newton(points, sign, half, width, shift)[0]
    near = np.abs(depths(points, half, shift)) < BESIDE
    shift, information = _newton(points[near], sign[near], half, FINE, shift)
    sigma = np.sqrt(np.diag(np.linalg.inv(information)))
    return _least_where_open(points, is_on, half, slack, FaceFit(shift, sigma))


def _least_where_open(points: Array, is_on: Array, half: Array, slack: float, found: FaceFit) -> FaceFit:
    """The same fit, but for the axes along which the points leave a wide range of shifts.

    The face covers all points on it, and none beside it that lie between its other two edges.
    """
    c, s = np.cos(found.shift[2]), np.sin(found.shift[2])
    R = np.array([[c, -s], [s, c]])
    turned, shift, sigma = points @ R, found.shift[:2] @ R, found.sigma.copy()
    for axis in (0, 1):
        on, across = turned[is_on, axis], turned[:, 1 - axis] - shift[1 - axis]
        off = turned[np.logical_not(is_on) & (np.abs(across) < half[1 - axis] - slack), axis]
        above, below = off[off > shift[axis]], off[off < shift[axis]]
        low = max(on.max(initial=-np.inf) - half[axis], below.max(initial=-np.inf) + half[axis])
        high = min(on.min(initial=np.inf) + half[axis], above.min(initial=np.inf) - half[axis])
        if high - low > OPEN:
            shift[axis] = np.clip(0.0, low, high)
            sigma[axis] = max(sigma[axis], min(0.5 * (high - low), PRIOR[axis]))
    return FaceFit(np.append(R @ shift, found.shift[2]), sigma)


def depths(points: Array, half: Array, shift: Array) -> Array:
    """How far points `(n, 2)` lie inside the nearest edge of a rectangle that was moved by `shift` [m]."""
    return inside(points, half, shift)[0]


def _newton(points: Array, sign: Array, half: Array, width: float, shift: Array) -> tuple[Array, Array]:
    """The best shift with one width of the edge, and the Fisher information of it `(3, 3)`."""
    information = np.diag(PRIOR**-2)
    for _ in range(STEPS):
        depth, slopes, _ = inside(points, half, shift)
        wrong = 1.0 / (1.0 + np.exp(np.clip(sign * depth / width, -50.0, 50.0)))
        gradient = slopes.T @ (sign * wrong) / width - shift / PRIOR**2
        weight = wrong * (1.0 - wrong) / width**2
        information = (slopes.T * weight) @ slopes + np.diag(PRIOR**-2)
        step = np.linalg.solve(information, gradient)
        step = step / max(1.0, float(np.max(np.abs(step) / LONGEST_STEP)))
        shift = shift + step
        if np.all(np.abs(step) < CLOSE):
            break
    return shift, information


def inside(points: Array, half: Array, shift: Array) -> tuple[Array, Array, Array]:
    """Depth of points inside the nearest edge, its slopes along the shift, and which edge that is.

    Args:
        points: `(n, 2)` [m].
        half: half the edges of the rectangle `(2,)` [m].
        shift: by which it was moved and turned `(3,)` [m, m, rad].

    Returns:
        The depth `(n,)` [m], the slopes `(n, 3)`, and the axis to which that edge is normal `(n,)`, 0 or 1.
    """
    c, s = np.cos(shift[2]), np.sin(shift[2])
    R = np.array([[c, -s], [s, c]])
    local = (points - shift[:2]) @ R
    depth = half - np.abs(local)
    nearest, rows = np.argmin(depth, axis=1), np.arange(len(points))
    side = np.sign(local[rows, nearest])
    # The face's x axis is (c, s), its y axis (-s, c); a turn moves local x by y, and local y by -x.
    turned = np.array([-1.0, 1.0])[nearest] * local[rows, 1 - nearest]
    slopes = np.column_stack([side[:, None] * R.T[nearest], side * turned])
    return depth[rows, nearest], slopes, nearest
