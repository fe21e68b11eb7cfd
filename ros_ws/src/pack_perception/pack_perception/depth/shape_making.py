"""What fits of shapes have in common: objects of given sizes, hulls, and extents of points."""

from __future__ import annotations

import numpy as np

from pack_core.hull import hull_of, with_fewer_corners
from pack_core.packing.convex_mesh import ConvexMesh
from pack_core.packing.objects import Box, Capsule, Cylinder, ObjectModel
from pack_core.rotations import Array, Pose, from_yaw
from pack_perception.depth.seen_region import DIRECTIONS
from pack_perception.perception_config import ShapeFitConfig

TAIL = 0.01
"""Share of a top's points that is left out at each edge."""
BASE_STEP = 4
"""In every so many directions the base of a hull keeps a corner."""
HULL_TOLERANCE = 0.001
"""By so much corners of a hull may be off that are left out [m]."""
THINNEST = 0.006
"""No object is thinner or lower [m]."""
SCALE = 0.001
"""Deviation from which a point counts less in a fit [m]."""
CONVERGED = 1e-4
"""Relative change of a fit's cost at which it ends: far less than errors of points change it."""


def described(
    cls: type[Box | Cylinder | Capsule],
    shape: str,
    name: str,
    config: ShapeFitConfig,
    volume: float,
    **sizes: object,
) -> ObjectModel:
    """An object of a kind with given sizes [m], its mass from its volume [m^3] and the density for all."""
    given = {"name": name, "mass": config.density * float(volume), **sizes}
    return cls.model_validate({**given, "shape": shape})


def mesh_of(points: Array, name: str, config: ShapeFitConfig) -> tuple[ObjectModel, Pose]:
    """The convex hull of points `(n, 3)` [m] with few corners, and X_WO of its bounding box's middle."""
    whole = hull_of(points)
    # corners within the tolerance are left out, and what stands on the rest alone might rock
    lowest = whole.corners[whole.corners[:, 2] < whole.corners[:, 2].min() + 1e-6]
    base = lowest[np.unique(np.argmax(lowest[:, :2] @ DIRECTIONS[::BASE_STEP].T, axis=0))]
    few = with_fewer_corners(whole, config.corners - len(base), HULL_TOLERANCE)
    hull = hull_of(np.concatenate([few.corners, base]))
    middle = 0.5 * (hull.corners.min(axis=0) + hull.corners.max(axis=0))
    item = ConvexMesh(
        name=name, shape="mesh", vertices=tuple(map(tuple, (hull.corners - middle).tolist())),
        mass=config.density * hull.volume,
    )  # fmt: skip
    return item, Pose(middle)


def upright(x: float, y: float, height: float, yaw: float) -> Pose:
    """X_WO of an object of a height [m] that stands on the base."""
    return Pose(np.array([x, y, 0.5 * height]), from_yaw(yaw))


def axes_of(yaw: float) -> Array:
    """Unit vectors along and across a heading, as columns `(2, 2)`."""
    c, s = np.cos(yaw), np.sin(yaw)
    return np.array([[c, -s], [s, c]])


def extents(p: Array) -> tuple[Array, Array]:
    """Lower and upper ends `(k,)` along each axis of what points `(n, k)` are evenly spread over."""
    first, last = np.quantile(p, [TAIL, 1.0 - TAIL], axis=0)
    beyond = TAIL * (last - first) / (1.0 - 2.0 * TAIL)
    return first - beyond, last + beyond


def tightest(xy: Array, yaws: Array) -> float:
    """The heading of the rectangle of least area around points `(n, 2)`."""
    lower, upper = extents(xy @ np.concatenate([axes_of(yaw) for yaw in yaws], axis=1))
    areas = np.prod((upper - lower).reshape(-1, 2), axis=1)
    return float(yaws[int(np.argmin(areas))])
