"""How the held object enters among the others: beside its obstacles, leaning over them, lower edge first.

Flat on top of an obstacle it would stand there. With its lower edge in the gap beside the obstacle it
wedges itself in; on the way down it moves over its place, aside goes the obstacle, and it is upright again.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
import shapely

from pack_core.rotations import Array, Pose
from pack_core.scene.free_space import footprint
from pack_core.scene.scene import Scene

ONE_SIDED = 0.3
"""Obstacles all around (length of the mean of their unit directions below this) leave no side to lean to."""
UPRIGHT_BELOW = 0.02
"""Height of the lower end at which the object is upright again [m]."""
ASIDE_MARGIN = 0.008
"""Between the lower edge and its obstacles at the entry [m]."""
LANDING_MARGIN = 0.04
"""A lower end this far below a top has passed it, tilted as it may be [m]."""


@dataclass(frozen=True)
class Placement:
    """A packing pose X_WN for the held object N.

    Attributes:
        X_WN: the pose.
        collisions: the objects that it overlaps, the collision list G.
        over: horizontal unit vector `(2,)` from the pose to its obstacles; zero without a clear side.
        aside: how far the lower end keeps off the pose at the entry `(2,)` [m].
        tops: heights of the obstacles [m].
    """

    X_WN: Pose
    collisions: tuple[str, ...]
    over: Array = field(default_factory=lambda: np.zeros(2))
    aside: Array = field(default_factory=lambda: np.zeros(2))
    tops: tuple[float, ...] = ()


def plan_entry(scene: Scene, X_WN: Pose, collisions: tuple[str, ...], poses: Mapping[str, Pose]) -> Placement:
    """The placement with its side to lean to and how far it keeps off, from where its obstacles stand."""
    if not collisions:
        return Placement(X_WN, collisions)
    offsets = np.array([poses[name].p[:2] - X_WN.p[:2] for name in collisions])
    lengths = np.maximum(np.linalg.norm(offsets, axis=1, keepdims=True), 1e-6)
    mean = (offsets / lengths).mean(axis=0)
    length = float(np.linalg.norm(mean))
    over = mean / length if length > ONE_SIDED else np.zeros(2)
    tops = tuple(2.0 * float(scene.model_of(name).half_extents[2]) for name in collisions)
    own = footprint(scene.new_object, X_WN)
    others = [footprint(scene.model_of(name), poses[name]) for name in collisions]
    depth = max(_extent(own.intersection(other), over) for other in others)
    aside = -(depth + ASIDE_MARGIN) * over if depth > 0.0 else np.zeros(2)
    return Placement(X_WN, collisions, over, aside, tops)


def _extent(area: shapely.Geometry, direction: Array) -> float:
    """How far the area reaches along a direction `(2,)` [m]."""
    along = shapely.get_coordinates(area) @ direction
    return float(np.ptp(along)) if along.size else 0.0


def entry_at(placement: Placement, lean: float, bottom: float) -> tuple[Array, Array]:
    """Tilt and offset with the lower end at height `bottom` [m]: all above the tops, none on the base.

    Returns:
        Wanted x and y `(2,)` of the object's z axis, and how far its lower end keeps off the pose `(2,)` [m].
    """
    top = max(placement.tops, default=0.0)
    if top <= UPRIGHT_BELOW:
        return np.zeros(2), np.zeros(2)
    share = float(np.clip((bottom - UPRIGHT_BELOW) / (top - UPRIGHT_BELOW), 0.0, 1.0))
    return np.sin(lean * share) * placement.over, share * placement.aside


def may_land(placement: Placement, walls: float, bottom: float) -> bool:
    """Whether the object, its lower end at height `bottom` [m], is not yet below all that it may land on.

    That is the tops of its obstacles and of the walls, `walls` [m] high.
    """
    return bottom > min((walls, *placement.tops)) - LANDING_MARGIN
