"""Which entries begin over a gap, told by geometry alone, so that few of many have to be rehearsed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import shapely
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

from pack_core.packing.free_space import footprint
from pack_core.packing.scene import Scene
from pack_core.packing.scene_item import SceneItem
from pack_core.rotations import Array, Pose, tilts
from pack_planner.placement.placement_result import PlacementCandidate

ENTERS_FIRST = 0.02
"""Height of the part of the tilted object that enters first, from its lowest point on [m]."""


def covered(scene: Scene, poses: Mapping[str, Pose], options: Sequence[PlacementCandidate]) -> Array:
    """Area `(n,)` [m^2] of what enters first that is over other objects or beyond the walls at the entry.

    Args:
        scene: the container, the objects and the new one, N.
        poses: X_WO of the objects in the container.
        options: n placements whose ways in have an offset.
    """
    container, parts = scene.container, first_parts(scene.new_object, options)
    taken = [footprint(scene.model_of(name), poses[name]) for name in scene.names]
    free = shapely.box(*container.lower, *container.upper).difference(shapely.union_all(taken))
    return np.asarray(shapely.area(parts) - shapely.area(shapely.intersection(parts, free)))


def first_parts(item: SceneItem, options: Sequence[PlacementCandidate]) -> Array:
    """Outlines `(n,)`, as seen from above, of what enters first: the lowest `ENTERS_FIRST` of the object."""
    over = np.array([option.way.over for option in options])
    turned = Rotation.from_quat([option.X_WN.q for option in options], scalar_first=True)
    leans = np.array([[option.way.lean] for option in options])
    R_WN = (Rotation.from_rotvec(tilts(leans * over)) * turned).as_matrix()
    # the hull's corners, tilted, with the lower end where the way in begins
    corners = item.hull() @ R_WN.transpose(0, 2, 1)
    ends = np.array([option.X_WN.p[:2] - (option.way.back or 0.0) * option.way.over for option in options])
    corners[..., :2] += (ends + item.half_extents[2] * R_WN[:, :2, 2])[:, None]
    # what enters first has the corners below this level, and the points at which edges cross it
    level = corners[..., 2].min(axis=1, keepdims=True) + ENTERS_FIRST
    a, b = corners[:, (edges := _edges(item))[:, 0]], corners[:, edges[:, 1]]
    crosses = (a[..., 2] < level) != (b[..., 2] < level)
    share = (level - a[..., 2]) / np.where(crosses, b[..., 2] - a[..., 2], 1.0)
    points = np.concatenate([corners, a + share[..., None] * (b - a)], axis=1)
    is_low = np.concatenate([corners[..., 2] <= level, crosses], axis=1)
    which = np.nonzero(is_low)[0]
    return np.asarray(shapely.convex_hull(shapely.multipoints(points[is_low][:, :2], indices=which)))


def _edges(item: SceneItem) -> Array:
    """Pairs of corners `(m, 2)` between which the hull has an edge, and diagonals of its faces."""
    triangles = ConvexHull(item.hull()).simplices
    return np.unique(np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1), axis=0)
