"""Where outlines have room in a container, while one after the other is put down.

The places of an outline's centre that another one takes are their no-fit polygon: the Minkowski sum of the
other and the negated outline. It depends on the two shapes alone, so it is computed once and moved about.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from pack_core.no_fit import no_fit_polygon
from pack_core.packing.free_space import footprint
from pack_core.packing.scene import Container
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


@dataclass(frozen=True)
class PlacedOutline:
    """An outline that stands with its centre at `xy` `(2,)` [m]."""

    outline: Outline
    xy: Array


class NoFitPolygons:
    """No-fit polygons of pairs of outlines, widened by the gap that they keep.

    Args:
        container: between whose walls outlines are to stand.
        gap: distance between outlines [m].
        wall_gap: distance from the walls [m].
    """

    def __init__(self, container: Container, gap: float, wall_gap: float) -> None:
        self._container, self._gap, self._wall_gap = container, gap, wall_gap
        self._known: dict[tuple[Outline, Outline], Array] = {}

    def between_walls(self, outline: Outline) -> shapely.Geometry:
        """Places of the centre at which the outline keeps its distance from the walls."""
        lower = self._container.lower + self._wall_gap - outline.corners.min(axis=0)
        upper = self._container.upper - self._wall_gap - outline.corners.max(axis=0)
        return shapely.Polygon() if np.any(lower > upper) else shapely.box(*lower, *upper)

    def of(self, placed: PlacedOutline, outline: Outline) -> shapely.Polygon:
        """Places of the centre of `outline` at which it is too near to a placed one."""
        pair = (placed.outline, outline)
        if (corners := self._known.get(pair)) is None:
            met = no_fit_polygon(placed.outline.corners, outline.corners).buffer(self._gap, quad_segs=2)
            corners = self._known[pair] = shapely.get_coordinates(met.simplify(COARSE / 2))
        return shapely.Polygon(corners + placed.xy)


class FreePlaces:
    """Places of outlines' centres that are free, up to date with what was put down.

    Args:
        no_fit: the no-fit polygons.
        start: what stands there already, with the free places of outlines; None: an empty container.
    """

    def __init__(self, no_fit: NoFitPolygons, start: FreePlaces | None = None) -> None:
        self._no_fit, self._start = no_fit, start
        self._placed: list[PlacedOutline] = []
        # free places of an outline, and how many of those put down they take into account
        self._known: dict[Outline, tuple[shapely.Geometry, int]] = {}

    def put(self, placed: Sequence[PlacedOutline]) -> None:
        """Note outlines that were put down."""
        self._placed.extend(placed)

    def of(self, outline: Outline) -> shapely.Geometry:
        """Places of the centre at which the outline keeps its distance from walls and other outlines."""
        if (known := self._known.get(outline)) is None:
            start = self._start
            known = (self._no_fit.between_walls(outline) if start is None else start.of(outline)), 0
        free, count = known
        for placed in self._placed[count:]:
            if free.is_empty:
                break
            free = free.difference(self._no_fit.of(placed, outline))
        self._known[outline] = free, len(self._placed)
        return free
