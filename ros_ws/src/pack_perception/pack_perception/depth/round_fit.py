"""Round shapes fitted to what was seen of an object: a lying capsule, a body of revolution, or a hull.

What was not seen follows from contact with the base: a capsule lies on it, and a round body is below its
middle as it is above it.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.optimize import least_squares

from pack_core.packing.objects import Capsule, ObjectModel
from pack_core.rotations import Array, Pose
from pack_perception.depth.height_map import HeightMap
from pack_perception.depth.seen_region import DIRECTIONS, SeenRegion
from pack_perception.depth.shape_making import CONVERGED, SCALE, axes_of, described, extents, mesh_of, upright
from pack_perception.perception_config import ShapeFitConfig

MOST_POINTS = 300
"""Points of a top that are kept."""
CLOSE_SHARE = 0.8
"""Share of the points that must be near a surface that explains them; others lie on something else."""
RING = 2
"""Of the directions every so many one is a corner of a body of revolution."""
WIDEST = 0.15
"""Largest radius of a body of revolution [m]."""
KNOTS = 7
"""Heights between which the radius of a body of revolution is linear."""
SHOULDER = 0.55
"""Share of its height above which a round body that is widest there goes straight down: it is no ball."""
BASE = 0.5
"""Least width of a round body's base in parts of its own: what stands does not stand on a point."""
SHORTNESS = 0.3
"""Weight of a capsule's length in a fit, a third of a point's: it decides where points say nothing."""

RoundFit = tuple[float, Callable[[], tuple[ObjectModel, Pose]]]
"""How far most points are from a surface [m], and what makes the shape and X_WO."""


def lying_capsule(points: Array, name: str, config: ShapeFitConfig) -> RoundFit | None:
    """The capsule that lies on the base, z = 0, by points `(n, 3)` [m] of its surface."""
    points = points[:: max(1, len(points) // 600)]
    middle = points[:, :2].mean(axis=0)
    _, _, axes = np.linalg.svd(points[:, :2] - middle, full_matrices=False)
    yaw = np.arctan2(axes[0, 1], axes[0, 0])
    lower, upper = extents((points[:, :2] - middle) @ axes_of(yaw))
    radius = 0.5 * float(np.percentile(points[:, 2], 98))
    half = max(0.5 * float(upper[0] - lower[0]) - radius, 0.001)

    def residuals(x: Array) -> Array:
        along, across = ((points[:, :2] - x[:2]) @ axes_of(x[2])).T
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
    item = described(Capsule, "capsule", name, config, volume, **sizes)
    return misfit_of(SCALE * residuals(fit.x)[:-1]), lambda: (item, upright(x, y, 2.0 * radius, yaw))


def misfit_of(distances: Array) -> float:
    """Distance from a surface [m] within which most of the points at distances `(n,)` are."""
    return float(np.quantile(np.abs(distances), CLOSE_SHARE))


def revolved(points: Array, name: str, config: ShapeFitConfig) -> RoundFit | None:
    """A body of revolution that stands on the base, z = 0; None if points `(n, 3)` [m] are off its surface.

    Its radius is linear between some heights. It is seen all around as soon as one side is.
    """
    points = points[:: max(1, len(points) // MOST_POINTS)]
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
    low, high = [-np.inf] * 2 + [0.0] * KNOTS, [np.inf] * 2 + [WIDEST] * KNOTS
    start = np.minimum(start, WIDEST).tolist()
    fit = least_squares(
        residuals, [*peak, *start], jacobian, loss="soft_l1", bounds=(low, high), ftol=CONVERGED, max_nfev=25
    )
    misfit = misfit_of(SCALE * residuals(fit.x))
    if misfit > config.close:
        return None
    circles = fit.x[:2] + fit.x[2:, None, None] * DIRECTIONS[::RING]
    rings = np.concatenate([np.insert(c, 2, z, axis=1) for c, z in zip(circles, knots, strict=True)])
    widest = float(knots[np.argmax(fit.x[2:])])
    return misfit, lambda: mesh_of(_completed(rings, widest, float(top)), name, config)


def round_hull(
    region: SeenRegion, name: str, config: ShapeFitConfig, heights: HeightMap
) -> tuple[ObjectModel, Pose] | None:
    """The hull of what was seen and of what is likely below its widest place."""
    height = float(np.percentile(region.top[:, 2], 99))
    cells = region.mask & np.isfinite(heights.tops)
    seen = np.column_stack([heights.centres(cells), heights.tops[cells]])
    widest = float(np.median(seen[np.argmax(seen[:, :2] @ DIRECTIONS.T, axis=0), 2]))
    return mesh_of(_completed(seen, widest, height), name, config)


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
