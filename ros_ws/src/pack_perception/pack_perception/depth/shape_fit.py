"""Shapes fitted to what was seen of an object: box, cylinder or hull of a flat top, or a round shape.

Tops say where an object ends, and sides where they were seen. Of points that are evenly spread over a top,
the share that lies beyond a line near its edge says how far the edge is; that is steadier than the outermost
point, which flies. Boxes and cylinders reach down to the base.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from operator import itemgetter

import numpy as np
import shapely
from scipy.optimize import least_squares

from pack_core.packing.objects import Box, Cylinder, ObjectModel
from pack_core.rotations import Array, Pose
from pack_perception.depth.height_map import HeightMap
from pack_perception.depth.round_fit import MOST_POINTS, lying_capsule, revolved, round_hull
from pack_perception.depth.seen_region import DIRECTIONS, SeenRegion, overlap
from pack_perception.depth.shape_making import (
    CONVERGED,
    HULL_TOLERANCE,
    SCALE,
    TAIL,
    THINNEST,
    axes_of,
    described,
    extents,
    mesh_of,
    tightest,
    upright,
)
from pack_perception.perception_config import ShapeFitConfig

DISC_TAIL = (TAIL * 3.0 * np.pi / (4.0 * np.sqrt(2.0))) ** (2.0 / 3.0)
"""Share of a disc's radius that this cuts: a low cap of height t has the area 4/3 sqrt(2 r) t^1.5."""
FEWEST_ENDS = 12
"""Directions in which a top is known to end by which a circle is fitted to it: a third of them."""
HANDICAP = 0.05
"""Overlap by which a hull must be better than a simple shape."""
COVERS = 0.75
"""Least overlap of a round shape with its region: a smaller one explains a part of it alone."""


@dataclass(frozen=True)
class FittedShape:
    """A shape and how well it explains what was seen.

    Attributes:
        item: the shape, its size and its mass.
        X_WO: where it is.
        score: overlap of its outline with the cells of its top, from 0 to 1.
        points: some of the points of its top `(n, 3)` [m].
    """

    item: ObjectModel
    X_WO: Pose
    score: float
    points: Array


Fit = Callable[[SeenRegion, str, ShapeFitConfig], tuple[ObjectModel, Pose] | None]
"""Makes a shape of what was seen, its name and parameters; None or ValueError if it cannot be one."""


def candidates(
    region: SeenRegion, heights: HeightMap, name: str, config: ShapeFitConfig, *, flat: bool, good: float
) -> list[FittedShape]:
    """All shapes that may have the region as their top, the best one first; none if too little was seen.

    Where a simple shape's overlap with a flat top is `good`, no hull is tried.
    """
    if len(region.top) < config.few:
        return []
    if not flat and (explained := _explained(region, heights, name, config)) is not None:
        return [explained]
    if not flat:
        return _fitted((partial(round_hull, heights=heights),), region, heights, name, config)
    shapes = _fitted((_box, _cylinder), region, heights, name, config)
    # a hull would be worth less, and takes longer than both
    if not shapes or shapes[0].score < max(good, 1.0 - HANDICAP):
        shapes += _fitted((partial(_prism, heights=heights),), region, heights, name, config)
    return sorted(shapes, key=worth, reverse=True)


def _fitted(
    kinds: Sequence[Fit], region: SeenRegion, heights: HeightMap, name: str, config: ShapeFitConfig
) -> list[FittedShape]:
    """The shapes of some kinds that a region may be, the best one first."""
    made = [_if_possible(partial(kind, region, name, config)) for kind in kinds]
    found = [fit for fit in made if fit is not None]
    shapes = [_judged(item, X_WO, region, heights) for item, X_WO in found]
    return sorted(shapes, key=worth, reverse=True)


def worth(shape: FittedShape) -> float:
    """By which shapes are compared: a simple one is more likely than a hull, which fits whatever was seen."""
    return shape.score - HANDICAP * (shape.item.shape == "mesh")


def _explained(
    region: SeenRegion, heights: HeightMap, name: str, config: ShapeFitConfig
) -> FittedShape | None:
    """The round shape whose surface what was seen lies on: it says how that goes on where nothing was."""
    fits = [fit for kind in (lying_capsule, revolved) if (fit := kind(region.top, name, config)) is not None]
    # a hull takes longer than its fit: it is made if no closer shape explains the region
    for misfit, make in sorted(fits, key=itemgetter(0)):
        if misfit < config.close and (made := _if_possible(make)) is not None:
            shape = _judged(*made, region, heights)
            if shape.score > COVERS:
                return shape
    return None


def _if_possible(make: Callable[[], tuple[ObjectModel, Pose] | None]) -> tuple[ObjectModel, Pose] | None:
    """What is made; None where what was seen is too thin or too small for it."""
    try:
        return make()
    except ValueError:
        return None


def _judged(item: ObjectModel, X_WO: Pose, region: SeenRegion, heights: HeightMap) -> FittedShape:
    few = region.top[:: max(1, len(region.top) // MOST_POINTS)]
    return FittedShape(item, X_WO, overlap([(item, X_WO)], region.mask, heights), few)


def _height(region: SeenRegion) -> float:
    return float(np.median(region.top[:, 2]))


def _box(region: SeenRegion, name: str, config: ShapeFitConfig) -> tuple[ObjectModel, Pose] | None:
    """The upright box of least area around the top, its sides moved to where they were seen."""
    xy = region.top[:: max(1, len(region.top) // 1500), :2]
    coarse = tightest(xy, np.deg2rad(np.arange(0.0, 90.0, 2.0)))
    yaw = tightest(xy, coarse + np.deg2rad(np.arange(-2.0, 2.1, 0.25)))
    lower, upper = extents(xy @ axes_of(yaw))
    height = _height(region)
    middle, half = axes_of(yaw) @ (0.5 * (lower + upper)), 0.5 * (upper - lower)
    sides = region.near[region.near[:, 2] < height - config.below, :2]
    own = [
        _side_points(sides, middle, yaw, half, axis, sign, config)
        if region.sight.sees(np.array([*middle, height]), np.array([*(sign * axes_of(yaw)[:, axis]), 0.0]))
        else sides[:0]
        for axis in (0, 1)
        for sign in (-1, 1)
    ]

    def residuals(x: Array) -> Array:
        axes, h = axes_of(x[2]), x[3:]
        parts = [
            (sign * ((points - x[:2]) @ axes[:, axis]) - h[axis])
            / SCALE
            / max(1.0, np.sqrt(len(points) / 30))
            for points, (axis, sign) in zip(own, ((0, -1), (0, 1), (1, -1), (1, 1)), strict=True)
        ]
        ends = axes.T @ x[:2]
        known = np.concatenate([ends - h - lower, ends + h - upper]) / config.top_deviation
        return np.concatenate([*parts, known, [(x[2] - yaw) / np.deg2rad(1.0)]])

    fit = least_squares(residuals, [*middle, yaw, *half], loss="soft_l1", ftol=CONVERGED)
    x, y, yaw = fit.x[:3]
    size = (*(2.0 * fit.x[3:]), height)
    if min(size) < THINNEST:
        return None
    return described(Box, "box", name, config, np.prod(size), size=size), upright(x, y, height, yaw)


def _side_points(
    points: Array, middle: Array, yaw: float, half: Array, axis: int, sign: int, config: ShapeFitConfig
) -> Array:
    """Those of `points` `(n, 2)` that are on one side of a rectangle; none if they are few."""
    p = (points - middle) @ axes_of(yaw)
    beside = np.abs(p[:, 1 - axis]) < half[1 - axis] - config.side
    on = beside & (np.abs(sign * p[:, axis] - half[axis]) < config.side)
    return points[on] if on.sum() >= config.few else points[:0]


def _cylinder(region: SeenRegion, name: str, config: ShapeFitConfig) -> tuple[ObjectModel, Pose] | None:
    """The upright cylinder around the top, its side moved to where it was seen."""
    xy, height = region.top[:, :2], _height(region)
    # where something hides a part, the last that was seen is not its edge
    ends = region.ends if region.ends.sum() >= FEWEST_ENDS else np.ones_like(region.ends)
    reach = np.quantile(xy @ DIRECTIONS[ends].T, 1.0 - TAIL, axis=0)
    # reach = d . c + r (1 - DISC_TAIL): linear in the centre and the radius
    A = np.column_stack([DIRECTIONS[ends], np.full(ends.sum(), 1.0 - DISC_TAIL)])
    x0, *_ = np.linalg.lstsq(A, reach)
    sides = region.near[region.near[:, 2] < height - config.below, :2]
    own = sides[np.abs(np.linalg.norm(sides - x0[:2], axis=1) - x0[2]) < config.side]
    own = own if len(own) >= config.few else own[:0]

    def residuals(x: Array) -> Array:
        side = (np.linalg.norm(own - x[:2], axis=1) - x[2]) / SCALE / max(1.0, np.sqrt(len(own) / 120))
        return np.asarray(np.concatenate([side, (A @ x - reach) / config.top_deviation / 2.0]))

    x, y, radius = least_squares(residuals, x0, loss="soft_l1", ftol=CONVERGED).x
    if min(radius, height) < THINNEST:
        return None
    volume = np.pi * radius**2 * height
    item = described(Cylinder, "cylinder", name, config, volume, radius=radius, height=height)
    return item, upright(x, y, height, 0.0)


def _prism(
    region: SeenRegion, name: str, config: ShapeFitConfig, heights: HeightMap
) -> tuple[ObjectModel, Pose]:
    """The hull of a flat top, straight down to the base."""
    hull = shapely.MultiPoint(heights.centres(region.mask)).convex_hull
    outline = shapely.get_coordinates(hull.simplify(HULL_TOLERANCE))[:-1]
    base, top = np.insert(outline, 2, 0.0, axis=1), np.insert(outline, 2, _height(region), axis=1)
    return mesh_of(np.concatenate([base, top]), name, config)
