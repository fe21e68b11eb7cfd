"""Convex outlines seen from above, and where one has room beside others."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely

from pack_core.packing.free_space import footprint
from pack_core.packing.scene import Container
from pack_core.packing.scene_item import SceneItem
from pack_core.rotations import Array, Pose, from_yaw

COARSE = 0.0003
"""Outlines are simplified by at most this, so that a circle has some twenty corners [m]."""


@dataclass(frozen=True)
class Outline:
    """An object's outline about its own centre at a yaw [rad]; `corners` `(n, 2)` [m]."""

    yaw: float
    corners: Array
    area: float

    @classmethod
    def of(cls, item: SceneItem, yaw: float) -> Outline:
        """The outline of an upright object."""
        polygon = footprint(item, Pose(np.zeros(3), from_yaw(yaw)))
        return cls(yaw, _corners(polygon), float(polygon.area))

    def at(self, xy: Array) -> Array:
        """The corners `(n, 2)` with the centre at `xy` [m]."""
        return self.corners + xy

    def room(self, container: Container, taken: list[Array], gap: float, wall_gap: float) -> shapely.Geometry:
        """Places of the centre at which the outline keeps its distance from walls and from other outlines.

        Args:
            container: between whose walls it is to stand.
            taken: corners `(m, 2)` of the other outlines.
            gap: distance from these [m].
            wall_gap: distance from the walls [m].
        """
        lower = container.lower + wall_gap - self.corners.min(axis=0)
        upper = container.upper - wall_gap - self.corners.max(axis=0)
        if np.any(lower > upper):
            return shapely.Polygon()
        # all outlines are convex, so the hull of the corners' differences is the whole Minkowski sum
        sums = [
            shapely.MultiPoint((other[:, None] - self.corners[None]).reshape(-1, 2)).convex_hull.buffer(
                gap, quad_segs=3
            )
            for other in taken
        ]
        return shapely.box(*lower, *upper).difference(shapely.union_all(sums))


def standing_outline(item: SceneItem, X_WO: Pose) -> Array:
    """Corners `(n, 2)` of an object that stands, leans or lies in the container at X_WO [m]."""
    return _corners(footprint(item, X_WO))


def _corners(polygon: shapely.Polygon) -> Array:
    return np.asarray(shapely.get_coordinates(polygon.simplify(COARSE).exterior)[:-1])
