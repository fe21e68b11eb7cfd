"""Whether a depth camera hangs where it is described: the container that it sees is the reference.

Base and walls of the container are known. The points near their surfaces are moved onto them by the method of
Gauss and Newton; how far that is at the container is how far off the camera is there.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from pack_core.camera import PinholeCamera
from pack_core.packing.scene import Container
from pack_core.rotations import Array, Pose, exp, rotate
from pack_perception.perception_config import RegistrationConfig


@dataclass(frozen=True)
class Registration:
    """How far off a camera is.

    Attributes:
        middle: of the container, about which it turns `(3,)` [m].
        shift: of the container's middle from where it is seen to where it is `(3,)` [m].
        turn: rotation vector between the same `(3,)` [rad].
    """

    middle: Array
    shift: Array
    turn: Array

    def applied_to(self, camera: PinholeCamera) -> PinholeCamera:
        """The camera where it truly hangs."""
        # X_WW' p = middle + shift + R (p - middle)
        q = exp(self.turn)
        moved = Pose(self.middle + self.shift - rotate(q, self.middle), q) @ camera.X_WC
        return replace(camera, X_WC=moved)

    def is_within(self, config: RegistrationConfig) -> bool:
        """Whether what the camera sees can be used."""
        is_near = np.linalg.norm(self.shift) <= config.shift
        return bool(is_near and np.linalg.norm(self.turn) <= np.deg2rad(config.turn_deg))

    def in_words(self) -> str:
        """How far off, for people."""
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
    faces = [face for face in faces_of(container) if face.is_seen_from(p_WC)]
    offsets = config.search * np.array([0.0, -1.0, 1.0])
    starts = [Registration(middle, np.array([x, y, 0.0]), np.zeros(3)) for x in offsets for y in offsets]
    few, reaches = points[:: config.every], config.reaches
    coarse = [_fitted(few, start, faces, reaches[:3], config) for start in starts]
    best = max(coarse, key=lambda found: _on_walls(few, found, faces, config.scale))
    found = _fitted(points, best, faces, reaches[2:], config)
    return found if _on_walls(points, found, faces, config.scale) >= config.few else None


def _fitted(
    points: Array, start: Registration, faces: Sequence[Face], reaches: Sequence[float],
    config: RegistrationConfig,
) -> Registration:  # fmt: skip
    """The registration that is reached from `start`, a step of Gauss and Newton for each reach [m]."""
    middle, shift, turn = start.middle, start.shift, start.turn
    r = points - middle
    for reach in reaches:
        distances, normals = _nearest(points + shift + np.cross(turn, r), faces, reach)
        near = np.isfinite(distances)
        n, d = normals[near], distances[near]
        # d distance = n . shift + (r x n) . turn, for small turns about the container's middle
        J = np.concatenate([n, np.cross(r[near], n)], axis=1)
        w = 1.0 / (1.0 + (d / config.scale) ** 2)
        # a weak prior: what nothing was seen of stays where it is described
        H = (J * w[:, None]).T @ J + np.diag([1.0, 1.0, 1.0, 0.01, 0.01, 0.01])
        step = np.linalg.solve(H, -(J * w[:, None]).T @ d)
        shift, turn = shift + step[:3], turn + step[3:]
    return Registration(middle, shift, turn)


def _on_walls(points: Array, found: Registration, faces: Sequence[Face], scale: float) -> int:
    """Number of points that lie on the walls' sides, which tell apart what the base leaves open."""
    moved = points + found.shift + np.cross(found.turn, points - found.middle)
    distances, normals = _nearest(moved, faces, scale)
    return int(np.count_nonzero(np.isfinite(distances) & (normals[:, 2] == 0.0)))


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

    def distances(self, points: Array, margin: float) -> Array:
        """Distances `(n,)` [m] of points `(n, 3)` in front of it or behind; inf for what is beside it."""
        across = self.sign * (points[:, self.axis] - self.low[self.axis])
        others = [axis for axis in range(3) if axis != self.axis]
        p, low, high = points[:, others], self.low[others] - margin, self.high[others] + margin
        return np.where(np.all((p > low) & (p < high), axis=1), across, np.inf)


def faces_of(container: Container) -> list[Face]:
    """The base, with the table around, and all faces of the walls that may be seen."""
    (x0, y0), (x1, y1) = container.lower, container.upper
    t, h = container.wall, container.height
    walls = (
        ((x0 - t, y0 - t), (x0, y1 + t)), ((x1, y0 - t), (x1 + t, y1 + t)),
        ((x0, y0 - t), (x1, y0)), ((x0, y1), (x1, y1 + t)),
    )  # fmt: skip
    faces = [Face(2, 1.0, np.array([-np.inf, -np.inf, 0.0]), np.array([np.inf, np.inf, 0.0]))]
    for (ax, ay), (bx, by) in walls:
        low, high = np.array([ax, ay, 0.0]), np.array([bx, by, h])
        for axis, sign in ((0, -1.0), (0, 1.0), (1, -1.0), (1, 1.0), (2, 1.0)):
            at = np.where(np.arange(3) == axis, low if sign < 0.0 else high, 0.0)
            others = np.arange(3) != axis
            faces.append(Face(axis, sign, np.where(others, low, at), np.where(others, high, at)))
    return faces


def _nearest(points: Array, faces: Sequence[Face], reach: float) -> tuple[Array, Array]:
    """Distances `(n,)` [m] from the nearest face, inf beyond `reach`, and its normals `(n, 3)`."""
    distances, normals = np.full(len(points), np.inf), np.zeros_like(points)
    for face in faces:
        way = face.distances(points, 0.5 * reach)
        closer = np.abs(way) < np.minimum(np.abs(distances), reach)
        distances[closer] = way[closer]
        normals[closer] = face.sign * np.eye(3)[face.axis]
    return distances, normals
