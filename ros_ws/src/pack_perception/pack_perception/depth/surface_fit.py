"""Poses of bodies of known shape, fitted to points of their surfaces.

Every shape is convex, so that the distance of a point from its surface is the largest of its distances from
the planes of its facets: exact in front of facets and inside, too small beyond edges. The method of Gauss and
Newton moves the body until its facets meet the points; what the points leave open, as a cylinder's yaw, stays
as expected.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.optimize import linear_sum_assignment

from pack_core.hull import hull_of
from pack_core.packing.objects import ObjectModel
from pack_core.packing.scene_item import SceneItem
from pack_core.rotations import Array, Pose, conjugate, exp, from_yaw, multiply, rotate, yaw_of
from pack_perception.depth.shape_fit import FittedShape
from pack_perception.perception_config import SurfaceFitConfig

MOST_POINTS = 250
"""Points of a body by which its pose is fitted: twice `SurfaceFitConfig.alike`, what brings something new."""


@dataclass(frozen=True)
class ConvexSurface:
    """The facets of a convex body.

    Attributes:
        normals: outward, in the body's frame `(m, 3)`.
        offsets: of their planes from the origin `(m,)` [m].
        radius: of the ball about the origin that holds the body [m].
    """

    normals: Array
    offsets: Array
    radius: float

    @classmethod
    def of(cls, item: SceneItem) -> ConvexSurface:
        """The surface of an object; triangles in one plane are one facet."""
        hull = hull_of(item.hull())
        planes = np.unique(np.column_stack([hull.normals, hull.offsets]).round(6), axis=0)
        return cls(planes[:, :3], planes[:, 3], float(np.linalg.norm(hull.corners, axis=1).max()))

    def distances(self, p_B: Array) -> tuple[Array, npt.NDArray[np.int_]]:
        """Distances `(n,)` [m] of points `(n, 3)`, negative inside, and their facets `(n,)`."""
        heights = p_B @ self.normals.T - self.offsets
        facets = np.argmax(heights, axis=1)
        return heights[np.arange(len(facets)), facets], facets


def assigned(points: Array, surfaces: Sequence[ConvexSurface], poses: Array, reach: float) -> list[Array]:
    """The points `(n, 3)` that are within `reach` of each body at `poses` `(k, 7)` and nearest to it.

    Of many some suffice, evenly chosen: `MOST_POINTS`.
    """
    nearest, owner = np.full(len(points), reach), np.full(len(points), -1)
    for i, surface in enumerate(surfaces):
        near = np.flatnonzero(np.linalg.norm(points - poses[i, :3], axis=1) < surface.radius + reach)
        p_B = rotate(conjugate(poses[i, 3:]), points[near] - poses[i, :3])
        distances = np.abs(surface.distances(p_B)[0])
        closer = distances < nearest[near]
        nearest[near[closer]], owner[near[closer]] = distances[closer], i
    parts = [points[owner == i] for i in range(len(surfaces))]
    return [part[:: max(1, len(part) // MOST_POINTS)] for part in parts]


GONE = 0.1
"""Points within a body, as a share of those on its surface, from which it is not where it was."""
OFF = 0.006
"""What is nearer to a body is a part of it [m]."""


def still_there(
    points: Array, surfaces: Sequence[ConvexSurface], poses: Array, reach: float
) -> tuple[npt.NDArray[np.bool_], Array]:
    """Which bodies at `poses` `(k, 7)` are still there, and the points `(n, 3)` that are not of them.

    A body is gone if something is seen farther within it than `reach` [m]; what nobody sees is still there.
    """
    is_there = np.ones(len(surfaces), dtype=bool)
    for i, surface in enumerate(surfaces):
        distances, _ = surface.distances(rotate(conjugate(poses[i, 3:]), points - poses[i, :3]))
        within = np.count_nonzero(distances < -reach)
        is_there[i] = within <= GONE * np.count_nonzero(np.abs(distances) <= reach)
        if is_there[i]:
            points = points[distances > OFF]
    return is_there, points


def fit_surface(surface: ConvexSurface, points: Array, pose: Array, config: SurfaceFitConfig) -> Array:
    """The pose `(7,)` of a body from points `(n, 3)` of its surface and the pose `(7,)` that is expected."""
    p, q = pose[:3].copy(), pose[3:].copy()
    prior = np.repeat([config.position, config.angle], 3) ** -2.0
    total = np.zeros(6)
    weight = min(1.0, config.alike / max(len(points), 1)) / config.scale**2
    for _ in range(config.iterations):
        distances, facets = surface.distances(rotate(conjugate(q), points - p))
        normals = rotate(q, surface.normals[facets])
        # d distance = -n . shift - (r x n) . turn, with the point at r from the body's origin
        J = -np.concatenate([normals, np.cross(points - p, normals)], axis=1)
        # Cauchy's weights: a point that is far off belongs to something else
        w = weight / (1.0 + (distances / config.scale) ** 2)
        H = (J * w[:, None]).T @ J + np.diag(prior)
        step = np.linalg.solve(H, -(J * w[:, None]).T @ distances - prior * total)
        total += step
        p, q = p + step[:3], multiply(exp(step[3:]), q)
    return np.concatenate([p, q])


OTHER_HEIGHT = 0.012
"""A shape whose top is so much higher or lower than what was seen is not tried [m]."""
UNLIKELY = 1.0
"""Cost of a shape that is not tried [m]; larger than every misfit."""
ROUNDING = 1e-6
"""Tolerance when angles are compared [rad]."""
HEADINGS = 8
"""Headings that are tried for what has no symmetry of a quarter turn."""


def which_is_where(
    found: Sequence[FittedShape], items: Sequence[ObjectModel], config: SurfaceFitConfig
) -> dict[str, Pose]:
    """X_WO of the described objects that were found, by name: each shape is at most at one place.

    Args:
        found: what a look saw.
        items: the described objects, standing upright.
        config: parameters.
    """
    if not found or not items:
        return {}
    poses = np.zeros((len(found), len(items), 7))
    costs = np.full((len(found), len(items)), UNLIKELY)
    for j, item in enumerate(items):
        surface = ConvexSurface.of(item)
        for i, fit in enumerate(found):
            top = fit.X_WO.p[2] + fit.item.half_extents[2]
            if abs(top - 2.0 * item.half_extents[2]) < OTHER_HEIGHT:
                costs[i, j], poses[i, j] = _best_heading(surface, item, fit, config)
    rows, columns = linear_sum_assignment(costs)
    return {
        items[j].name: Pose(poses[i, j, :3], poses[i, j, 3:])
        for i, j in zip(rows.tolist(), columns.tolist(), strict=True)
        if costs[i, j] < UNLIKELY
    }


def _best_heading(
    surface: ConvexSurface, item: ObjectModel, fit: FittedShape, config: SurfaceFitConfig
) -> tuple[float, Array]:
    """Misfit [m] and pose `(7,)` of an object where something was seen, at the heading that fits best."""
    start = yaw_of(fit.X_WO.q)
    turns = np.arange(HEADINGS) * 2.0 * np.pi / HEADINGS
    best, pose = np.inf, np.zeros(7)
    for turn in turns[turns < max(item.symmetry - ROUNDING, ROUNDING)]:
        p = np.array([*fit.X_WO.p[:2], item.half_extents[2]])
        tried = fit_surface(surface, fit.points, np.concatenate([p, from_yaw(start + turn)]), config)
        misfit = _misfit(surface, item, fit, tried)
        if misfit < best:
            best, pose = misfit, tried
    return best, pose


def _misfit(surface: ConvexSurface, item: ObjectModel, fit: FittedShape, pose: Array) -> float:
    """How far points are from a shape, and how much it is larger or smaller than what was seen [m]."""
    distances, _ = surface.distances(rotate(conjugate(pose[3:]), fit.points - pose[:3]))
    seen, described = np.sort(fit.item.half_extents[:2]), np.sort(item.half_extents[:2])
    return float(np.mean(np.minimum(np.abs(distances), 0.02)) + 0.25 * np.abs(seen - described).sum())
