"""Whether a depth camera hangs where it is described: the container that it sees is the reference.

Base and walls of the container are known. The points near their surfaces are moved onto them by the method of
Gauss and Newton; how far that is at the container is how far off the camera is there. A camera that was
knocked farther than is searched can end in a place that fits less badly than others. It is told by what no
camera can see: points behind the walls, on lines of sight that would pass through them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numba
import numpy as np
import numpy.typing as npt

from pack_core.camera import PinholeCamera
from pack_core.packing.scene import Container
from pack_core.rotations import Array, Pose, exp, rotate
from pack_perception.perception_config import RegistrationConfig

Labels = npt.NDArray[np.int64]
FaceTable = tuple[Labels, Array, Array, Array]

SEEN_THROUGH = 0.1
"""Share of the points at walls that are behind them from which the container is not where it was found."""
BEHIND = 0.01
"""What is so much farther away than a wall is behind it [m]."""
EDGE = 0.002
"""Lines of sight that pass a wall's edges within this may pass beside it [m]."""


@dataclass(frozen=True)
class Registration:
    """How far off a camera is.

    Attributes:
        middle: of the container, about which it turns `(3,)` [m].
        shift: of the container's middle from where it is seen to where it is `(3,)` [m].
        turn: rotation vector between the same `(3,)` [rad].
        seen_through: share of the points at walls that are behind them, where that puts the container.
    """

    middle: Array
    shift: Array
    turn: Array
    seen_through: float = 0.0

    def applied_to(self, camera: PinholeCamera) -> PinholeCamera:
        """The camera where it truly hangs."""
        # X_WW' p = middle + shift + R (p - middle)
        q = exp(self.turn)
        moved = Pose(self.middle + self.shift - rotate(q, self.middle), q) @ camera.X_WC
        return replace(camera, X_WC=moved)

    def is_within(self, config: RegistrationConfig) -> bool:
        """Whether what the camera sees can be used."""
        is_near = np.linalg.norm(self.shift) <= config.shift and self.seen_through <= SEEN_THROUGH
        return bool(is_near and np.linalg.norm(self.turn) <= np.deg2rad(config.turn_deg))

    def in_words(self) -> str:
        """How far off, for people."""
        if self.seen_through > SEEN_THROUGH:
            return "more than the container can tell, through whose walls it would have to see"
        shift, turn = 1e3 * np.linalg.norm(self.shift), np.rad2deg(np.linalg.norm(self.turn))
        return f"{shift:.0f} mm and {turn:.1f} degrees"


def register(
    points: Array, p_WC: Array, container: Container, config: RegistrationConfig
) -> Registration | None:
    """How far the points of one camera are off the container.

    Args:
        points: `(n, 3)` [m], by the camera's described pose.
        p_WC: where the camera is described to be `(3,)` [m]: it sees no backs.
        container: what is seen in them.
        config: parameters.

    Returns:
        None if too little of the container was seen.
    """
    middle = np.array([*container.centre, 0.5 * container.height])
    faces = _as_table([face for face in faces_of(container) if face.is_seen_from(p_WC)])
    offsets = config.search * np.array([0.0, -1.0, 1.0])
    starts = [Registration(middle, np.array([x, y, 0.0]), np.zeros(3)) for x in offsets for y in offsets]
    few, reaches = np.ascontiguousarray(points[:: config.every]), config.reaches
    coarse = [_fitted(few, start, faces, reaches[:3], config) for start in starts]
    best = max(coarse, key=lambda found: _on_walls(few, found, faces, config.scale))
    found = _fitted(points, best, faces, reaches[2:], config)
    if _on_walls(points, found, faces, config.scale) < config.few:
        found = starts[0]
    q = exp(found.turn)
    moved = middle + found.shift + rotate(q, points - middle)
    on, behind = _at_walls(moved, middle + found.shift + rotate(q, p_WC - middle), container)
    return replace(found, seen_through=behind / (on + behind)) if on + behind >= config.few else None


def _at_walls(points: Array, p_WC: Array, container: Container) -> tuple[int, int]:
    """How many points `(n, 3)` [m] are on walls as seen from p_WC `(3,)`, and how many are behind them."""
    ways = points - p_WC
    is_on, is_behind = np.zeros((2, len(points)), dtype=bool)
    for low, high in _walls_of(container):
        # in parts of the way to a point: where it enters a wall, and where it leaves that
        with np.errstate(divide="ignore"):
            ends = np.stack([low + EDGE - p_WC, high - EDGE - p_WC])[:, None] / ways
        enters, leaves = ends.min(axis=0).max(axis=1), ends.max(axis=0).min(axis=1)
        beyond = np.where(enters < leaves, (1.0 - enters) * np.linalg.norm(ways, axis=1), -np.inf)
        is_behind |= beyond > BEHIND
        is_on |= np.abs(beyond) <= BEHIND
    return int(np.count_nonzero(is_on & ~is_behind)), int(np.count_nonzero(is_behind))


def _fitted(
    points: Array, start: Registration, faces: FaceTable, reaches: Sequence[float],
    config: RegistrationConfig,
) -> Registration:  # fmt: skip
    """The registration that is reached from `start`, a step of Gauss and Newton for each reach [m]."""
    middle, shift, turn = start.middle, start.shift, start.turn
    # a weak prior: what nothing was seen of stays where it is described
    prior = np.diag([1.0, 1.0, 1.0, 0.01, 0.01, 0.01])
    for reach in reaches:
        found = _normal_equations(points, middle, shift, turn, *faces, reach, config.scale)
        step = np.linalg.solve(found[:, :6] + prior, found[:, 6])
        shift, turn = shift + step[:3], turn + step[3:]
    return Registration(middle, shift, turn)


def _on_walls(points: Array, found: Registration, faces: FaceTable, scale: float) -> int:
    """Number of points that lie on the walls' sides, which tell apart what the base leaves open."""
    moved = points + found.shift + np.cross(found.turn, points - found.middle)
    return int(_beside(moved, *faces, scale))


@dataclass(frozen=True)
class Face:
    """A rectangle across an axis of the world.

    Attributes:
        axis: number of the axis.
        sign: of its outward normal along it.
        low: corner with the smallest coordinates `(3,)` [m].
        high: corner with the largest `(3,)` [m].
    """

    axis: int
    sign: float
    low: Array
    high: Array

    def is_seen_from(self, p_WC: Array) -> bool:
        """Whether its front is towards a camera."""
        return bool(self.sign * (p_WC[self.axis] - self.low[self.axis]) > 0.0)


def faces_of(container: Container) -> list[Face]:
    """The base, with the table around, and all faces of the walls that may be seen."""
    faces = [Face(2, 1.0, np.array([-np.inf, -np.inf, 0.0]), np.array([np.inf, np.inf, 0.0]))]
    for low, high in _walls_of(container):
        for axis, sign in ((0, -1.0), (0, 1.0), (1, -1.0), (1, 1.0), (2, 1.0)):
            at = np.where(np.arange(3) == axis, low if sign < 0.0 else high, 0.0)
            others = np.arange(3) != axis
            faces.append(Face(axis, sign, np.where(others, low, at), np.where(others, high, at)))
    return faces


def _walls_of(container: Container) -> list[tuple[Array, Array]]:
    """The corners with the smallest and the largest coordinates of each wall `(3,)` [m]."""
    (x0, y0), (x1, y1) = container.lower, container.upper
    t, h = container.wall, container.height
    sides = (
        ((x0 - t, y0 - t), (x0, y1 + t)), ((x1, y0 - t), (x1 + t, y1 + t)),
        ((x0, y0 - t), (x1, y0)), ((x0, y1), (x1, y1 + t)),
    )  # fmt: skip
    return [(np.array([*low, 0.0]), np.array([*high, h])) for low, high in sides]


def _as_table(faces: Sequence[Face]) -> FaceTable:
    """Axes `(k,)`, signs `(k,)`, and lower and upper corners `(k, 3)` [m] of faces."""
    return (
        np.array([face.axis for face in faces]), np.array([face.sign for face in faces]),
        np.array([face.low for face in faces]), np.array([face.high for face in faces]),
    )  # fmt: skip


@numba.njit(cache=True)
def _nearest(
    x: float, y: float, z: float, axes: Labels, signs: Array, lows: Array, highs: Array, reach: float
) -> tuple[int, float]:
    """Number of the face that a point is nearest to, and how far it is in front of it [m].

    It is -1 where none is within `reach` [m]. Faces go on beyond their edges by half of that.
    """
    p, nearest, least = (x, y, z), -1, reach
    for k in range(len(axes)):
        way = signs[k] * (p[axes[k]] - lows[k, axes[k]])
        is_over = abs(way) < abs(least)
        for i in range(3):
            if i != axes[k] and not lows[k, i] - 0.5 * reach < p[i] < highs[k, i] + 0.5 * reach:
                is_over = False
        if is_over:
            nearest, least = k, way
    return nearest, least


@numba.njit(
    "f8[:, ::1](f8[:, ::1], f8[::1], f8[::1], f8[::1], i8[::1], f8[::1], f8[:, ::1], f8[:, ::1], f8, f8)",
    cache=True,
)
def _normal_equations(
    points: Array, middle: Array, shift: Array, turn: Array, axes: Labels, signs: Array, lows: Array,
    highs: Array, reach: float, scale: float,
) -> Array:  # fmt: skip
    """Matrix and right side of a step of Gauss and Newton, side by side `(6, 7)`, by Cauchy's weights."""
    found, J = np.zeros((6, 7)), np.zeros(6)
    for row in range(len(points)):
        rx, ry, rz = points[row, 0] - middle[0], points[row, 1] - middle[1], points[row, 2] - middle[2]
        x = points[row, 0] + shift[0] + turn[1] * rz - turn[2] * ry
        y = points[row, 1] + shift[1] + turn[2] * rx - turn[0] * rz
        z = points[row, 2] + shift[2] + turn[0] * ry - turn[1] * rx
        k, d = _nearest(x, y, z, axes, signs, lows, highs, reach)
        if k < 0:
            continue
        # d distance = n . shift + (r x n) . turn, for small turns about the container's middle
        J[:] = 0.0
        J[axes[k]] = signs[k]
        J[3] = ry * J[2] - rz * J[1]
        J[4] = rz * J[0] - rx * J[2]
        J[5] = rx * J[1] - ry * J[0]
        w = 1.0 / (1.0 + (d / scale) ** 2)
        for i in range(6):
            for j in range(6):
                found[i, j] += w * J[i] * J[j]
            found[i, 6] -= w * J[i] * d
    return found


@numba.njit("i8(f8[:, ::1], i8[::1], f8[::1], f8[:, ::1], f8[:, ::1], f8)", cache=True)
def _beside(points: Array, axes: Labels, signs: Array, lows: Array, highs: Array, scale: float) -> int:
    """Number of points within `scale` [m] of a face that stands upright, and of no nearer one."""
    count = 0
    for row in range(len(points)):
        k, _ = _nearest(points[row, 0], points[row, 1], points[row, 2], axes, signs, lows, highs, scale)
        count += k >= 0 and axes[k] != 2
    return count
