"""How the held object enters among the others: beside its obstacles, leaning over them, lower edge first.

Lowered upright onto an obstacle, the object would come to rest on top of it. So its lower edge enters the
gap beside the obstacle first, a little off the walls, whose tops would stop it likewise. On the way down it
moves over its packing pose, which pushes the obstacle aside, and turns upright again.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

import numpy as np
import shapely

from pack_core.packing.free_space import footprint
from pack_core.packing.scene import Container, Scene
from pack_core.rotations import Array, Pose

ONE_SIDED = 0.3
"""The mean of the unit vectors to the obstacles is shorter than this where they stand all around: no side."""
UPRIGHT_BELOW = 0.02
"""Height of the object's lower end over the base below which it is upright again [m]."""
ASIDE_MARGIN = 0.008
"""Gap between the object's lower edge and its obstacles at the entry, where there is room [m]."""
WALL_MARGIN = 0.005
"""Gap between the object's lower face and the walls at the entry, where there is room [m]."""
LANDING_MARGIN = 0.04
"""A lower end this far below the top of an obstacle or a wall has passed it, even when tilted [m]."""


@dataclass(frozen=True)
class Entry:
    """The way down to a packing pose X_WN of the held object N.

    Attributes:
        over: horizontal unit vector `(2,)` towards which the upper end leans; zero: straight down.
        lean: tilt at the entry [rad].
        aside: horizontal offset `(2,)` of the lower end from the packing pose at the entry [m].
        tops: heights over the base of the tops of obstacles, and of a wall that it keeps off [m].
        beside: heights of the tops of neighbours, which an object that is a little off its way may meet [m].
    """

    over: Array = field(default_factory=lambda: np.zeros(2))
    lean: float = 0.0
    aside: Array = field(default_factory=lambda: np.zeros(2))
    tops: tuple[float, ...] = ()
    beside: tuple[float, ...] = ()

    def at(self, bottom: Array | float) -> tuple[Array, Array]:
        """Tilt and offset while the lower end is at heights `bottom` `(...)` [m].

        Both have their full value above the tops and fall linearly to zero at `UPRIGHT_BELOW`.

        Returns:
            Desired x and y components `(..., 2)` of the object's z axis, and the horizontal offset `(..., 2)`
            of its lower end from the packing pose [m].
        """
        span = max(max(self.tops, default=0.0) - UPRIGHT_BELOW, 0.0)
        heights = np.clip(np.asarray(bottom)[..., None] - UPRIGHT_BELOW, 0.0, span)
        share = heights / span if span > 0.0 else heights
        return np.sin(self.lean * share) * self.over, share * self.aside

    def may_land(self, walls: float, bottom: float) -> bool:
        """Whether the object, its lower end at height `bottom` [m], could still land on something.

        It could until it has passed the tops of obstacles and neighbours, and the walls, `walls` [m] high.
        """
        return bottom > min((walls, *self.tops, *self.beside)) - LANDING_MARGIN


@dataclass(frozen=True)
class WayIn:
    """How the held object is to enter.

    Attributes:
        over: horizontal unit vector `(2,)` towards which its upper end leans; zero: to no side.
        lean: tilt at the entry [rad].
        back: distance [m], against `over`, at which its lower end begins beside the packing pose, whatever
            is there; None: just beside its obstacles.
    """

    over: Array = field(default_factory=lambda: np.zeros(2))
    lean: float = 0.0
    back: float | None = None


def plan_entry(
    scene: Scene, X_WN: Pose, collisions: tuple[str, ...], poses: Mapping[str, Pose], way: WayIn,
    reach: float = 0.0,
) -> Entry:  # fmt: skip
    """The entry by this way, its lower end offset to the side from which it leans away.

    Unless the way has an offset of its own, it is the deepest overlap with an obstacle along `over`, plus a
    margin. It is changed where the lower face would come too close to a wall; the wall then counts among the
    tops. An offset of its own may begin above anything, so everything counts among the tops.

    Args:
        scene: the container, the objects and the new one, N.
        X_WN: the packing pose.
        collisions: names of the objects that N overlaps at X_WN (the collision list G of Algorithm 1).
        poses: X_WO of at least these objects.
        way: to which side N leans, how far, and where its lower end begins.
        reach: distance from the packing pose within which objects count as neighbours [m].
    """
    own, height = footprint(scene.new_object, X_WN), scene.container.height
    if way.back is not None:
        aside, tops = -way.back * way.over, (*_tops(scene, scene.names), height)
    else:
        others = [footprint(scene.model_of(name), poses[name]) for name in collisions]
        depth = max((_extent(own.intersection(other), way.over) for other in others), default=0.0)
        wanted = -(depth + ASIDE_MARGIN) * way.over if depth > 0.0 else np.zeros(2)
        face = _lower_face(own, X_WN.p[:2], way.over, way.lean)
        aside, tops = _off_the_walls(scene.container, face, wanted, way.over), _tops(scene, collisions)
        if not np.array_equal(aside, wanted):
            tops = (*tops, height)
    near = tuple(
        name
        for name in (scene.names if reach > 0.0 else ())
        if name not in collisions and footprint(scene.model_of(name), poses[name]).distance(own) < reach
    )
    return Entry(way.over, way.lean, aside, tops, _tops(scene, near))


def side_of(X_WN: Pose, collisions: tuple[str, ...], poses: Mapping[str, Pose]) -> Array:
    """Horizontal unit vector `(2,)` from the pose to its obstacles; zero without a clear side."""
    offsets = np.array([poses[name].p[:2] - X_WN.p[:2] for name in collisions]).reshape(-1, 2)
    # an obstacle right below the pose gives no direction: the bound keeps its unit vector zero instead of NaN
    lengths = np.maximum(np.linalg.norm(offsets, axis=1, keepdims=True), 1e-6)
    mean = (offsets / lengths).sum(axis=0) / max(len(collisions), 1)
    length = float(np.linalg.norm(mean))
    return np.asarray(mean / length) if length > ONE_SIDED else np.zeros(2)


def _tops(scene: Scene, names: Iterable[str]) -> tuple[float, ...]:
    # an object stands on the base, so its height is twice its half extent
    return tuple(2.0 * float(scene.model_of(name).half_extents[2]) for name in names)


def _off_the_walls(container: Container, face: shapely.Polygon, wanted: Array, over: Array) -> Array:
    """The offset `(2,)` [m] nearest to the wanted one with which the lower face keeps off the walls.

    Where this takes from the gap to the obstacles, which are on the side `over`, both margins shrink by
    the same share.
    """
    aside = _within_walls(container, face, wanted, WALL_MARGIN)
    missing = float((aside - wanted) @ over)
    share = np.clip(missing / (WALL_MARGIN + ASIDE_MARGIN), 0.0, 1.0)
    return _within_walls(container, face, wanted, (1.0 - share) * WALL_MARGIN)


def _within_walls(container: Container, outline: shapely.Polygon, shift: Array, margin: float) -> Array:
    """The shift `(2,)` [m], limited so that the shifted outline keeps a margin [m] off the walls.

    An outline that is too large for that is put into the middle.
    """
    lower, upper = np.array(outline.bounds).reshape(2, 2)
    least, most = container.lower + margin - lower, container.upper - margin - upper
    middle = 0.5 * (least + most)
    return np.clip(shift, np.minimum(least, middle), np.maximum(most, middle))


def _lower_face(own: shapely.Polygon, p: Array, over: Array, lean: float) -> shapely.Polygon:
    """The outline of the lower face at the entry: the upright one about `p` `(2,)`, shorter along `over`."""
    points = shapely.get_coordinates(own) - p
    along = (points @ over)[:, None] * over
    return shapely.Polygon(p + points - (1.0 - np.cos(lean)) * along)


def _extent(area: shapely.Geometry, direction: Array) -> float:
    """Length of the area along a unit direction `(2,)` [m]."""
    along = shapely.get_coordinates(area) @ direction
    return float(np.ptp(along)) if along.size else 0.0
