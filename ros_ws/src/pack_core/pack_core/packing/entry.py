"""How the held object enters among the others: beside its obstacles, leaning over them, lower edge first.

Flat on top of an obstacle it would stand there. With its lower edge in the gap beside the obstacle it
wedges itself in; on the way down it moves over its place, aside goes the obstacle, and it is upright again.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
import shapely

from pack_core.packing.free_space import footprint
from pack_core.packing.scene import Container, Scene
from pack_core.rotations import Array, Pose

ONE_SIDED = 0.3
"""Obstacles all around (length of the mean of their unit directions below this) leave no side to lean to."""
UPRIGHT_BELOW = 0.02
"""Height of the lower end at which the object is upright again [m]."""
ASIDE_MARGIN = 0.008
"""Between the lower edge and its obstacles at the entry [m]."""
LANDING_MARGIN = 0.04
"""A lower end this far below a top has passed it, tilted as it may be [m]."""


@dataclass(frozen=True)
class Entry:
    """The way down to a packing pose X_WN of the held object N.

    Attributes:
        over: horizontal unit vector `(2,)` towards which the upper end leans; zero: straight down.
        lean: by how much, at the entry [rad].
        aside: how far the lower end keeps off the pose at the entry `(2,)` [m].
        tops: heights of the obstacles [m].
    """

    over: Array = field(default_factory=lambda: np.zeros(2))
    lean: float = 0.0
    aside: Array = field(default_factory=lambda: np.zeros(2))
    tops: tuple[float, ...] = ()

    def at(self, bottom: Array | float) -> tuple[Array, Array]:
        """Tilt and offset with the lower end at heights `bottom` `(...)` [m].

        All of both above the tops, none on the base.

        Returns:
            Wanted x and y `(..., 2)` of the object's z axis, and how far its lower end keeps off the pose
            `(..., 2)` [m].
        """
        span = max(max(self.tops, default=0.0) - UPRIGHT_BELOW, 0.0)
        heights = np.clip(np.asarray(bottom)[..., None] - UPRIGHT_BELOW, 0.0, span)
        share = heights / span if span > 0.0 else heights
        return np.sin(self.lean * share) * self.over, share * self.aside

    def may_land(self, walls: float, bottom: float) -> bool:
        """Whether the object, its lower end at height `bottom` [m], is not yet below all it may land on.

        That is the tops of its obstacles and of the walls, `walls` [m] high.
        """
        return bottom > min((walls, *self.tops)) - LANDING_MARGIN


def plan_entry(
    scene: Scene, X_WN: Pose, collisions: tuple[str, ...], poses: Mapping[str, Pose], lean: float, over: Array
) -> Entry:
    """The entry that leans `over`, its lower end off the pose by the deepest overlap that way, or to a wall.

    Args:
        scene: the container, the objects and the new one, N.
        X_WN: the packing pose.
        collisions: objects that it overlaps.
        poses: X_WO of these.
        lean: tilt at the entry [rad].
        over: horizontal unit vector `(2,)`, or zero.
    """
    own = footprint(scene.new_object, X_WN)
    others = [footprint(scene.model_of(name), poses[name]) for name in collisions]
    depth = max((_extent(own.intersection(other), over) for other in others), default=0.0)
    aside = -(depth + ASIDE_MARGIN) * over if depth > 0.0 else np.zeros(2)
    tops = tuple(2.0 * float(scene.model_of(name).half_extents[2]) for name in collisions)
    return Entry(over, lean, _within_walls(scene.container, own, aside), tops)


def side_of(X_WN: Pose, collisions: tuple[str, ...], poses: Mapping[str, Pose]) -> Array:
    """Horizontal unit vector `(2,)` from the pose to its obstacles; zero without a clear side."""
    offsets = np.array([poses[name].p[:2] - X_WN.p[:2] for name in collisions]).reshape(-1, 2)
    lengths = np.maximum(np.linalg.norm(offsets, axis=1, keepdims=True), 1e-6)
    mean = (offsets / lengths).sum(axis=0) / max(len(collisions), 1)
    length = float(np.linalg.norm(mean))
    return np.asarray(mean / length) if length > ONE_SIDED else np.zeros(2)


def _within_walls(container: Container, outline: shapely.Polygon, shift: Array) -> Array:
    """The shift `(2,)` [m], cut off where it would bring the outline into a wall."""
    lower, upper = np.array(outline.bounds).reshape(2, 2)
    least, most = np.minimum(container.lower - lower, 0.0), np.maximum(container.upper - upper, 0.0)
    return np.clip(shift, least, most)


def _extent(area: shapely.Geometry, direction: Array) -> float:
    """How far the area reaches along a direction `(2,)` [m]."""
    along = shapely.get_coordinates(area) @ direction
    return float(np.ptp(along)) if along.size else 0.0
