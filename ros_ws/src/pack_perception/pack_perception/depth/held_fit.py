"""The object on the cup as depth cameras see it: its shape, its size, and how it hangs.

Over the container the cameras see its sides all around, and where they end below; its top is at the cup. In
the frame S in which shapes are fitted, the origin is the cup's and z points up, so that what hangs there has
heights from 0 down to less its own.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.optimize import least_squares

from pack_core.camera import PinholeCamera
from pack_core.packing.objects import Box, Cylinder, ObjectModel
from pack_core.packing.scene_item import SceneItem
from pack_core.packing.seen_deviations import SeenDeviations
from pack_core.rotations import POINTING_DOWN, Array, Pose, exp, from_yaw, multiply, rotate
from pack_perception.depth.height_map import Labels
from pack_perception.depth.seen_region import DIRECTIONS
from pack_perception.depth.shape_making import CONVERGED, SCALE, axes_of, mesh_of, tightest
from pack_perception.perception_config import DepthConfig, HeldFitConfig, ShapeFitConfig

X_TS = Pose(np.zeros(3), POINTING_DOWN)
"""The cup's z axis points down."""
LAYER = 0.005
"""Height of the layers in which points are counted, and of those of a hull [m]."""
TYPICAL = 8
"""Layers below the cup that have as many points as others of the same body."""
SPARSE = 0.2
"""Share of their points below which a layer is beneath the body: single points fly there."""
SECTORS = 16
"""Directions in which the body's sides are seen, and where they end below."""
HIDDEN = 0.05
"""A direction with less than this share of the points of the best one is hidden: single points fly there."""
ALL_AROUND = 12
"""Directions of `SECTORS` that are seen of a body between two cameras: of a round one neither sees its sides
where it looks along them. One camera alone sees half of them."""
LOWEST = 3
"""Of the points in a sector the lowest but two counts as the end: one or two may fly."""
TOP = 0.01
"""What is nearer to the cup's height is the top [m]."""
INSIDE = 0.004
"""What is farther within the sides is no edge of them [m]."""
FEWEST_ON_TOP = 100
"""Fewer points do not tell how high the top is."""
MOST = 0.95
"""Share of the points that are near the sides of what they belong to; others fly."""
OUTERMOST = 0.08
"""Share of a layer's points in a direction whose median is a corner of the hull: some of them fly."""


@dataclass(frozen=True)
class HeldShape:
    """What hangs on the cup.

    Attributes:
        item: its shape and size, with the name, mass, friction and colour that were told.
        X_TN: how it hangs from the cup T.
        deviations: how sure that is: of its middle on the cup, its size and its heading.
    """

    item: ObjectModel
    X_TN: Pose
    deviations: SeenDeviations


@dataclass(frozen=True)
class _Prism:
    """An upright box or cylinder whose sides explain points; its axis leans.

    Attributes:
        middle: where the axis is at the cup's height `(2,)` [m].
        slope: change of the axis's place for each metre upwards `(2,)` [m/m].
        half: half lengths across, or a cylinder's radius `(2,)` or `(1,)` [m].
        yaw: its heading [rad].
    """

    middle: Array
    slope: Array
    half: Array
    yaw: float = 0.0

    @property
    def q_SN(self) -> Array:
        """How it is turned, as a quaternion."""
        return multiply(exp(np.array([-self.slope[1], self.slope[0], 0.0])), from_yaw(self.yaw))

    def outside(self, points: Array) -> Array:
        """How far points `(n, 3)` are outside of the nearest side, negative within `(n,)` [m]."""
        p = points[:, :2] - self.middle - points[:, 2:] * self.slope
        if len(self.half) == 1:
            return np.asarray(np.linalg.norm(p, axis=1) - self.half)
        return np.asarray(np.max(np.abs(p @ axes_of(self.yaw)) - self.half, axis=1))

    def misfit(self, sides: Array) -> float:
        """Distance from the sides within which most of `sides` `(n, 3)` are [m]."""
        return float(np.quantile(np.abs(self.outside(sides)), MOST))


def held_shape(
    points: Array, cameras: Sequence[PinholeCamera], X_WT: Pose, told: SceneItem, depth: DepthConfig
) -> HeldShape | None:
    """The shape of what hangs on the cup; None if too little of it is seen.

    Args:
        points: all that was measured `(n, 3)` [m].
        cameras: those that measured them.
        X_WT: where the cup was.
        told: what was told of it: name, mass, friction and colour.
        depth: parameters.
    """
    config = depth.held
    body = _body((X_WT @ X_TS).inverse().apply(points), config)
    if body is None:
        return None
    sides = body[(body[:, 2] < -TOP) & (body[:, 2] > body[:, 2].min() + TOP)]
    if not len(sides):  # it is flatter than what is left out at its ends
        return None
    some = sides[:: max(1, len(sides) // config.most)]
    prism = min((_box(some), _cylinder(some)), key=lambda fit: fit.misfit(some))
    end = _lower_end(body, rotate(prism.q_SN, np.array([0.0, 0.0, 1.0])))
    # on average the lowest of the points that are a pitch apart is half of it above the end
    end += 0.5 * _pitch(cameras, X_WT.apply([0.0, 0.0, end]))
    kept = {name: getattr(told, name) for name in ("name", "mass", "friction", "colour")}
    if prism.misfit(some) > config.close:
        item, X_SN = _hull(sides, end, kept, depth.look.shapes)
        side, below, yaw = config.hull_end, config.hull_below, None
    else:
        top = _top(body, prism)
        item = _object(prism, top + end, kept)
        z = 0.5 * (top - end)
        X_SN = Pose(np.append(prism.middle + z * prism.slope, z), prism.q_SN)
        side, below = config.end, config.below
        yaw = side / float(prism.half.max()) if isinstance(item, Box) else None
    deviations = SeenDeviations(
        position=(side, side, 0.5 * below), size=(2.0 * side, 2.0 * side, below), yaw=yaw
    )
    return HeldShape(item, X_TS @ X_SN, deviations)


def _pitch(cameras: Sequence[PinholeCamera], p: Array) -> float:
    """Distance between what two pixels see of an upright side at `p` `(3,)`, one above the other [m]."""
    ways = [p - camera.X_WC.p for camera in cameras]
    # a pixel is 1 / f of the distance wide across its ray, which meets the side obliquely
    return float(np.mean([w @ w / (c.f * np.linalg.norm(w[:2])) for c, w in zip(cameras, ways, strict=True)]))


def _object(prism: _Prism, height: float, kept: Mapping[str, Any]) -> ObjectModel:
    """The box or the cylinder of a height [m]."""
    if len(prism.half) == 1:
        return Cylinder(shape="cylinder", radius=float(prism.half[0]), height=height, **kept)
    return Box(shape="box", size=(*(2.0 * prism.half).tolist(), height), **kept)


def _top(body: Array, prism: _Prism) -> float:
    """Height of the top over the cup's lip, which gives way, where it is seen beside it [m]; else 0."""
    flat = body[(body[:, 2] > -TOP) & (prism.outside(body) < -INSIDE), 2]
    return float(np.median(flat)) if len(flat) > FEWEST_ON_TOP else 0.0


def _body(p_S: Array, config: HeldFitConfig) -> Array | None:
    """Those of `p_S` `(n, 3)` that are of what hangs there; None if they are few, or not all around.

    It ends at the first layer in which next to nothing is seen: what is in the container is farther below.
    """
    near = p_S[(np.linalg.norm(p_S[:, :2], axis=1) < config.reach) & (p_S[:, 2] < TOP)]
    counts = np.bincount(np.maximum(-near[:, 2] / LAYER, 0.0).astype(int), minlength=TYPICAL + 2)
    least = max(SPARSE * float(np.median(counts[1 : TYPICAL + 1])), config.few)
    sparse = np.flatnonzero(counts[1:] < least)
    layers = len(counts) if not len(sparse) else int(sparse[0]) + 1
    # the layer in which it ends has few points
    body = near[near[:, 2] > -(layers + 1) * LAYER]
    # the top is left out: one camera alone sees it all around
    in_sectors = np.bincount(_sectors(body[body[:, 2] < -TOP]), minlength=SECTORS)
    if layers < 3 or np.count_nonzero(in_sectors > HIDDEN * in_sectors.max()) < ALL_AROUND:
        return None
    return np.asarray(body)


def _sectors(body: Array) -> Labels:
    """In which of `SECTORS` about the cup's axis points `(n, 3)` are `(n,)`."""
    x, y = body[:, :2].T
    return np.asarray(((np.arctan2(y, x) + np.pi) / (2.0 * np.pi) * SECTORS).astype(int) % SECTORS)


def _lower_end(body: Array, axis: Array) -> float:
    """How far down along an axis `(3,)` sides are seen, in the median of all directions [m]."""
    depths, sectors = -(body @ axis), _sectors(body)
    ends = [np.sort(own)[-LOWEST] for i in range(SECTORS) if len(own := depths[sectors == i]) >= LOWEST]
    return float(np.median(ends))


def _box(sides: Array) -> _Prism:
    """The box whose sides points `(n, 3)` are nearest to."""
    xy = sides[:, :2]
    yaw = tightest(xy, np.deg2rad(np.arange(-45.0, 45.0)))
    low, high = np.quantile(xy @ axes_of(yaw), [0.02, 0.98], axis=0)
    start = [*(axes_of(yaw) @ (0.5 * (low + high))), 0.0, 0.0, *(0.5 * (high - low)), yaw]
    return _fitted(lambda x: _Prism(x[:2], x[2:4], x[4:6], float(x[6])), start, sides)


def _cylinder(sides: Array) -> _Prism:
    """The cylinder whose side points `(n, 3)` are nearest to."""
    middle = sides[:, :2].mean(axis=0)
    radius = float(np.median(np.linalg.norm(sides[:, :2] - middle, axis=1)))
    return _fitted(lambda x: _Prism(x[:2], x[2:4], x[4:]), [*middle, 0.0, 0.0, radius], sides)


def _fitted(make: Callable[[Array], _Prism], start: Sequence[float], sides: Array) -> _Prism:
    """The prism whose sides are nearest to points `(n, 3)`."""

    def residuals(x: Array) -> Array:
        return make(x).outside(sides) / SCALE

    return make(least_squares(residuals, start, loss="soft_l1", ftol=CONVERGED).x)


def _hull(
    sides: Array, end: float, kept: Mapping[str, Any], config: ShapeFitConfig
) -> tuple[ObjectModel, Pose]:
    """The hull of the sides' outlines in layers, up to the cup and down to the lower end; X_SN is upright."""
    layers = (-sides[:, 2] / LAYER).astype(int)
    few = 0.5 * float(np.median(np.bincount(layers - layers.min())))
    rings = [_outline(own) for k in np.unique(layers) if len(own := sides[layers == k]) > few]
    ends = [
        np.column_stack([ring[:, :2], np.full(len(ring), z)])
        for ring, z in ((rings[-1], 0.0), (rings[0], -end))
    ]
    item, X_SN = mesh_of(np.concatenate([*rings, *ends]), "held", config)
    return item.model_copy(update=dict(kept)), X_SN


def _outline(layer: Array) -> Array:
    """Where a layer of points `(n, 3)` is outermost in each direction, `(36, 3)`."""
    first = np.argsort(-(layer[:, :2] @ DIRECTIONS.T), axis=0)[: max(1, int(OUTERMOST * len(layer)))]
    return np.asarray(np.median(layer[first], axis=0))
