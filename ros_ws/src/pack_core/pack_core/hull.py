"""Convex hulls of points, by Qhull: facets, volume, and hulls with fewer corners."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from pack_core.rotations import Array


@dataclass(frozen=True)
class Hull:
    """A convex polyhedron with its facets as triangles.

    Attributes:
        corners: `(n, 3)` [m].
        faces: numbers of each triangle's corners `(m, 3)`, counter-clockwise as seen from outside.
        normals: outward normals of the triangles `(m, 3)`.
        offsets: a point p is inside if `normals @ p <= offsets`, `(m,)` [m].
    """

    corners: Array
    faces: npt.NDArray[np.int_]
    normals: Array
    offsets: Array

    @property
    def triangles(self) -> Array:
        """Corners of each triangle `(m, 3, 3)` [m]."""
        return np.asarray(self.corners[self.faces])

    @property
    def volume(self) -> float:
        """Volume [m^3]: that of the tetrahedra which the triangles span with one point."""
        return float(np.linalg.det(self.triangles - self.corners.mean(axis=0)).sum() / 6.0)

    def volume_below(self, height: float) -> float:
        """Volume of what is below z = `height` [m^3]."""
        above = self.corners[:, 2] > height
        if not above.any() or above.all():
            return 0.0 if above.all() else self.volume
        ends = self.triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2, 3)
        lower, upper = ends[(ends[:, 0, 2] <= height) & (ends[:, 1, 2] > height)].swapaxes(0, 1)
        shares = (height - lower[:, 2]) / (upper[:, 2] - lower[:, 2])
        crossings = lower + shares[:, None] * (upper - lower)
        try:
            return hull_of(np.concatenate([self.corners[~above], crossings])).volume
        except ValueError:  # it reaches below by next to nothing
            return 0.0

    @property
    def centroid(self) -> Array:
        """Centre of the volume `(3,)` [m]: that of the tetrahedra which the triangles span with one point."""
        apex = self.corners.mean(axis=0)
        volumes = np.linalg.det(self.triangles - apex)
        middles = (self.triangles.sum(axis=1) + apex) / 4.0
        return np.asarray(volumes @ middles / volumes.sum())

    def heights(self, points: Array) -> Array:
        """How far each of `points` `(k, 3)` is outside [m]; negative inside, where it is the distance."""
        return np.asarray((points @ self.normals.T - self.offsets).max(axis=1))

    def exits(self, start: Array, directions: Array) -> tuple[Array, Array]:
        """Where rays from a point inside leave, `(k, 3)` [m], and the normals there `(k, 3)`.

        Args:
            start: the point `(3,)` [m].
            directions: of the rays, `(k, 3)`.
        """
        rates = directions @ self.normals.T
        room = self.offsets - self.normals @ start
        ways = np.where(rates > 1e-12, room / np.maximum(rates, 1e-12), np.inf)
        facets = np.argmin(ways, axis=1)
        length = ways[np.arange(len(facets)), facets]
        return start + length[:, None] * directions, self.normals[facets]


def hull_of(points: Array) -> Hull:
    """The convex hull of points `(k, 3)`.

    Raises:
        ValueError: they have no volume, or are no finite numbers.
    """
    from scipy.spatial import ConvexHull, QhullError  # 0.3 s and 20 MB, which a node without meshes saves

    try:
        found = ConvexHull(points)
    except QhullError:
        raise ValueError("points that span a volume; these lie in a plane, a line or a point") from None
    number = np.full(len(points), -1)
    number[found.vertices] = np.arange(len(found.vertices))
    normals, offsets = found.equations[:, :3], -found.equations[:, 3]
    faces, a, b, c = number[found.simplices], *np.moveaxis(points[found.simplices], 1, 0)
    # Qhull's triangles run either way round
    is_inward = np.einsum("ij,ij->i", np.cross(b - a, c - a), normals) < 0.0
    faces[is_inward] = faces[is_inward][:, ::-1]
    return Hull(points[found.vertices], faces, normals, offsets)


def extremes(hull: Hull, most: int = 2000) -> Hull:
    """The hull of the corners that are the farthest in one of `most` directions; of few corners the same."""
    if len(hull.corners) <= most:
        return hull
    # directions evenly spread over the ball, on a spiral that turns by the golden angle
    k = np.arange(most)
    z, turn = 1.0 - (2 * k + 1) / most, np.pi * (3.0 - np.sqrt(5.0)) * k
    level = np.sqrt(1.0 - z * z)
    directions = np.column_stack([level * np.cos(turn), level * np.sin(turn), z])
    directions = np.concatenate([directions, np.eye(3), -np.eye(3)])  # so that the size stays
    # in parts, since all at once would take gigabytes
    farthest = [np.argmax(hull.corners @ part.T, axis=0) for part in np.array_split(directions, most // 50)]
    return hull_of(hull.corners[np.unique(np.concatenate(farthest))])


def with_fewer_corners(hull: Hull, most: int, tolerance: float) -> Hull:
    """A hull of some of the corners, chosen one by one, always the one that is farthest outside so far.

    Args:
        hull: the hull.
        most: corners that the result has at most.
        tolerance: no more corners are taken once all are this close [m].
    """
    corners = hull.corners
    # two along each axis are on the bounding box, so that its size stays; the rest makes it a volume
    chosen = list(dict.fromkeys([*corners.argmin(axis=0), *corners.argmax(axis=0)]))
    while len(chosen) < 4 or np.linalg.matrix_rank(corners[chosen] - corners[chosen[0]], tol=1e-6) < 3:
        centred = corners - corners[chosen[0]]
        _, _, axes = np.linalg.svd(centred[chosen], full_matrices=True)
        rank = int(np.linalg.matrix_rank(centred[chosen], tol=1e-6))
        chosen.append(int(np.argmax(np.abs(centred @ axes[rank]))))
    while True:
        found = hull_of(corners[chosen])
        heights = found.heights(corners)
        farthest = int(np.argmax(heights))
        if heights[farthest] <= tolerance or len(chosen) >= most:
            return found
        chosen.append(farthest)
