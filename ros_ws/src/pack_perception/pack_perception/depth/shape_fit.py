"""Shapes fitted to what was seen of an object: box, cylinder, lying capsule, or a hull.

Tops say where an object ends, and sides where they were seen. Of points that are evenly spread over a top,
the share that lies beyond a line near its edge says how far the edge is; that is steadier than the outermost
point, which flies. What was not seen follows from contact with the base: boxes and cylinders reach down to
it, a capsule lies on it, and a round body is below its middle as it is above it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from operator import itemgetter

import numpy as np
import shapely
from scipy.optimize import least_squares

from pack_core.hull import hull_of, with_fewer_corners
from pack_core.packing.convex_mesh import ConvexMesh
from pack_core.packing.objects import Box, Capsule, Cylinder, ObjectModel
from pack_core.rotations import Array, Pose, from_yaw
from pack_perception.depth.height_map import HeightMap
from pack_perception.depth.seen_region import DIRECTIONS, SeenRegion, overlap
from pack_perception.perception_config import ShapeFitConfig

TAIL = 0.01
"""Share of a top's points that is left out at each edge."""
DISC_TAIL = (TAIL * 3.0 * np.pi / (4.0 * np.sqrt(2.0))) ** (2.0 / 3.0)
"""Share of a disc's radius that this cuts: a low cap of height t has the area 4/3 sqrt(2 r) t^1.5."""
FEWEST_ENDS = 12
"""Directions in which a top is known to end by which a circle is fitted to it: a third of them."""
MOST_POINTS = 300
"""Points of a top that are kept."""
HANDICAP = 0.05
"""Overlap by which a hull must be better than a simple shape."""
COVERS = 0.75
"""Least overlap of a round shape with its region: a smaller one explains a part of it alone."""
CLOSE_SHARE = 0.8
"""Share of the points that must be near a surface that explains them; others lie on something else."""
BASE_STEP = 4
"""In every so many directions the base of a hull keeps a corner."""
RING = 2
"""Of the directions every so many one is a corner of a body of revolution."""
KNOTS = 7
"""Heights between which the radius of a body of revolution is linear."""
SHOULDER = 0.55
"""Share of its height above which a round body that is widest there goes straight down: it is no ball."""
BASE = 0.5
"""Least width of a round body's base in parts of its own: what stands does not stand on a point."""
HULL_TOLERANCE = 0.001
"""By so much corners of a hull may be off that are left out [m]."""
THINNEST = 0.006
"""No object is thinner or lower [m]."""
SCALE = 0.001
"""Deviation from which a point counts less in a fit [m]."""
CONVERGED = 1e-4
"""Relative change of a fit's cost at which it ends: far less than errors of points change it."""
SHORTNESS = 0.3
"""Weight of a capsule's length in a fit, a third of a point's: it decides where points say nothing."""


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
        return _fitted((partial(_round_hull, heights=heights),), region, heights, name, config)
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
    fits = [fit for kind in (_lying_capsule, _revolved) if (fit := kind(region, name, config)) is not None]
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
    coarse = _tightest(xy, np.deg2rad(np.arange(0.0, 90.0, 2.0)))
    yaw = _tightest(xy, coarse + np.deg2rad(np.arange(-2.0, 2.1, 0.25)))
    lower, upper = _extents(xy @ _axes(yaw))
    height = _height(region)
    middle, half = _axes(yaw) @ (0.5 * (lower + upper)), 0.5 * (upper - lower)
    sides = region.near[region.near[:, 2] < height - config.below, :2]
    own = [
        _side_points(sides, middle, yaw, half, axis, sign, config)
        if region.sight.sees(np.array([*middle, height]), np.array([*(sign * _axes(yaw)[:, axis]), 0.0]))
        else sides[:0]
        for axis in (0, 1)
        for sign in (-1, 1)
    ]

    def residuals(x: Array) -> Array:
        axes, h = _axes(x[2]), x[3:]
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
    return _described(Box, "box", name, config, np.prod(size), size=size), _upright(x, y, height, yaw)


def _side_points(
    points: Array, middle: Array, yaw: float, half: Array, axis: int, sign: int, config: ShapeFitConfig
) -> Array:
    """Those of `points` `(n, 2)` that are on one side of a rectangle; none if they are few."""
    p = (points - middle) @ _axes(yaw)
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
    item = _described(Cylinder, "cylinder", name, config, volume, radius=radius, height=height)
    return item, _upright(x, y, height, 0.0)


RoundFit = tuple[float, Callable[[], tuple[ObjectModel, Pose]]]
"""How far most points are from a surface [m], and what makes the shape and X_WO."""


def _lying_capsule(region: SeenRegion, name: str, config: ShapeFitConfig) -> RoundFit | None:
    """A capsule that lies on the base."""
    points = region.top[:: max(1, len(region.top) // 600)]
    middle = points[:, :2].mean(axis=0)
    _, _, axes = np.linalg.svd(points[:, :2] - middle, full_matrices=False)
    yaw = np.arctan2(axes[0, 1], axes[0, 0])
    lower, upper = _extents((points[:, :2] - middle) @ _axes(yaw))
    radius = 0.5 * float(np.percentile(points[:, 2], 98))
    half = max(0.5 * float(upper[0] - lower[0]) - radius, 0.001)

    def residuals(x: Array) -> Array:
        along, across = ((points[:, :2] - x[:2]) @ _axes(x[2])).T
        beyond = along - np.clip(along, -x[3], x[3])
        ways = np.sqrt(beyond**2 + across**2 + (points[:, 2] - x[4]) ** 2)
        # an end that nobody saw is where the shortest capsule has it
        return np.append((ways - x[4]) / SCALE, SHORTNESS * x[3] / SCALE)

    low, high = [-np.inf] * 3 + [0.0006, 0.006], [np.inf] * 3 + [0.2, 0.1]
    start = np.clip([*middle, yaw, half, radius], low, high)
    fit = least_squares(residuals, start, loss="soft_l1", bounds=(low, high), ftol=CONVERGED)
    x, y, yaw, half, radius = fit.x
    volume = np.pi * radius**2 * (2.0 * half + 4.0 / 3.0 * radius)
    sizes = {"radius": radius, "length": 2.0 * (half + radius), "axis": "x"}
    item = _described(Capsule, "capsule", name, config, volume, **sizes)
    return _misfit(SCALE * residuals(fit.x)[:-1]), lambda: (item, _upright(x, y, 2.0 * radius, yaw))


def _misfit(distances: Array) -> float:
    """Distance from a surface [m] within which most of the points at distances `(n,)` are."""
    return float(np.quantile(np.abs(distances), CLOSE_SHARE))


def _revolved(region: SeenRegion, name: str, config: ShapeFitConfig) -> RoundFit | None:
    """A body of revolution that stands on the base; None if what was seen is off its surface, or too thin.

    Its radius is linear between some heights. It is seen all around as soon as one side is.
    """
    points = region.top[:: max(1, len(region.top) // MOST_POINTS)]
    bottom, top = np.quantile(points[:, 2], [0.02, 0.99])
    knots = np.linspace(bottom, top, KNOTS)
    peak = points[points[:, 2] > top - 0.2 * (top - bottom), :2].mean(axis=0)

    z, each = points[:, 2], np.eye(KNOTS)  # radii and slopes are linear in the radii at the knots
    to_radii = np.stack([np.interp(z, knots, one) for one in each], axis=1)
    middles = 0.5 * (knots[1:] + knots[:-1])
    to_slopes = np.stack([np.interp(z, middles, np.diff(one) / np.diff(knots)) for one in each], axis=1)

    def parts(x: Array) -> tuple[Array, Array, Array, Array]:
        """Distances from the axis, from the side and from the top, and what the side's slopes take off."""
        from_axis = np.linalg.norm(points[:, :2] - x[:2], axis=1)
        # across the surface: of steep profiles radii tell, of flat ones heights
        across = 1.0 / np.sqrt(1.0 + (to_slopes @ x[2:]) ** 2)
        # up to its radius at the top it ends in a disc, as a cap does
        from_disc = np.where(from_axis < x[-1], np.abs(z - top), np.inf)
        return from_axis, (from_axis - to_radii @ x[2:]) * across, from_disc, across

    def residuals(x: Array) -> Array:
        _, from_side, from_disc, _ = parts(x)
        return np.asarray(np.minimum(np.abs(from_side), from_disc) / SCALE)

    def jacobian(x: Array) -> Array:
        """Without the change of slopes, of which residuals depend little."""
        from_axis, from_side, from_disc, across = parts(x)
        weight = np.where(np.abs(from_side) < from_disc, np.sign(from_side) * across, 0.0) / SCALE
        away = (x[:2] - points[:, :2]) / np.maximum(from_axis, 1e-9)[:, None]
        return np.asarray(weight[:, None] * np.concatenate([away, -to_radii], axis=1))

    distances = np.linalg.norm(points[:, :2] - peak, axis=1)
    rows = np.clip(np.searchsorted(knots, points[:, 2]), 0, KNOTS - 1)
    start = [np.median(distances[rows == i]) if np.any(rows == i) else 0.01 for i in range(KNOTS)]
    low, high = [-np.inf] * 2 + [0.0] * KNOTS, [np.inf] * 2 + [0.15] * KNOTS
    fit = least_squares(
        residuals, [*peak, *start], jacobian, loss="soft_l1", bounds=(low, high), ftol=CONVERGED, max_nfev=25
    )
    misfit = _misfit(SCALE * residuals(fit.x))
    if misfit > config.close:
        return None
    circles = fit.x[:2] + fit.x[2:, None, None] * DIRECTIONS[::RING]
    rings = np.concatenate([np.insert(c, 2, z, axis=1) for c, z in zip(circles, knots, strict=True)])
    widest = float(knots[np.argmax(fit.x[2:])])
    return misfit, lambda: _mesh(_completed(rings, widest, float(top)), name, config)


def _round_hull(
    region: SeenRegion, name: str, config: ShapeFitConfig, heights: HeightMap
) -> tuple[ObjectModel, Pose] | None:
    """The hull of what was seen and of what is likely below its widest place."""
    height = float(np.percentile(region.top[:, 2], 99))
    cells = region.mask & np.isfinite(heights.tops)
    seen = np.column_stack([heights.centres(cells), heights.tops[cells]])
    widest = float(np.median(seen[np.argmax(seen[:, :2] @ DIRECTIONS.T, axis=0), 2]))
    return _mesh(_completed(seen, widest, height), name, config)


def _completed(seen: Array, widest: float, height: float) -> Array:
    """Points `(n, 3)` of an upper surface with likely ones below, down to the base.

    A body that is widest about its middle, such as a fruit, is there as it is above; one that is widest lower
    down likewise, as far as the base leaves room; one that is widest high up, such as a bottle, goes straight
    down.

    Args:
        seen: points `(m, 3)` [m].
        widest: height of its widest place [m].
        height: of its top [m].
    """
    if widest > SHOULDER * height:
        below = seen * [1.0, 1.0, 0.0]
    else:
        below = seen * [1.0, 1.0, -1.0] + [0.0, 0.0, 2.0 * min(widest, 0.5 * height)]
    middle = seen[:, :2].mean(axis=0)
    base = np.insert(middle + BASE * (seen[:, :2] - middle), 2, 0.0, axis=1)
    return np.concatenate([seen, below[below[:, 2] >= 0.0], base])


def _prism(
    region: SeenRegion, name: str, config: ShapeFitConfig, heights: HeightMap
) -> tuple[ObjectModel, Pose]:
    """The hull of a flat top, straight down to the base."""
    hull = shapely.MultiPoint(heights.centres(region.mask)).convex_hull
    outline = shapely.get_coordinates(hull.simplify(HULL_TOLERANCE))[:-1]
    base, top = np.insert(outline, 2, 0.0, axis=1), np.insert(outline, 2, _height(region), axis=1)
    return _mesh(np.concatenate([base, top]), name, config)


def _mesh(points: Array, name: str, config: ShapeFitConfig) -> tuple[ObjectModel, Pose]:
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


def _described(
    cls: type[Box | Cylinder | Capsule],
    shape: str,
    name: str,
    config: ShapeFitConfig,
    volume: float,
    **sizes: object,
) -> ObjectModel:
    given = {"name": name, "mass": config.density * float(volume), **sizes}
    return cls.model_validate({**given, "shape": shape})


def _upright(x: float, y: float, height: float, yaw: float) -> Pose:
    return Pose(np.array([x, y, 0.5 * height]), from_yaw(yaw))


def _axes(yaw: float) -> Array:
    """Unit vectors along and across a heading, as columns `(2, 2)`."""
    c, s = np.cos(yaw), np.sin(yaw)
    return np.array([[c, -s], [s, c]])


def _extents(p: Array) -> tuple[Array, Array]:
    """Lower and upper ends `(k,)` along each axis of what points `(n, k)` are evenly spread over."""
    first, last = np.quantile(p, [TAIL, 1.0 - TAIL], axis=0)
    beyond = TAIL * (last - first) / (1.0 - 2.0 * TAIL)
    return first - beyond, last + beyond


def _tightest(xy: Array, yaws: Array) -> float:
    """The heading of the rectangle of least area around points `(n, 2)`."""
    lower, upper = _extents(xy @ np.concatenate([_axes(yaw) for yaw in yaws], axis=1))
    areas = np.prod((upper - lower).reshape(-1, 2), axis=1)
    return float(yaws[int(np.argmin(areas))])
