"""Convex outlines seen from above."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely

from pack_core.packing.free_space import footprint
from pack_core.packing.scene_item import SceneItem
from pack_core.rotations import Array, Pose, from_yaw

COARSE = 0.0003
"""Outlines are simplified by at most this, so that a circle has some twenty corners [m]."""


@dataclass(frozen=True, eq=False)
class Outline:
    """A convex outline about a point of its own: an object's at a yaw [rad]; `corners` `(n, 2)` [m].

    Two outlines are the same only if they are the same instance, so that what is computed of one is kept.
    """

    yaw: float
    corners: Array
    area: float

    @classmethod
    def of(cls, item: SceneItem, yaw: float) -> Outline:
        """The outline of an upright object about its centre."""
        return cls._about(np.zeros(2), item, Pose(np.zeros(3), from_yaw(yaw)), yaw)

    @classmethod
    def standing(cls, item: SceneItem, X_WO: Pose) -> Outline:
        """The outline of an object that stands, leans or lies at X_WO, about its centre."""
        return cls._about(X_WO.p[:2], item, X_WO, 0.0)

    @classmethod
    def _about(cls, xy: Array, item: SceneItem, X_WO: Pose, yaw: float) -> Outline:
        polygon = footprint(item, X_WO)
        corners = np.asarray(shapely.get_coordinates(polygon.simplify(COARSE).exterior)[:-1])
        return cls(yaw, corners - xy, float(polygon.area))
