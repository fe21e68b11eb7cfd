"""What a round of rehearsals tries: placements, each with ways in.

Which of the random ways begin over a gap is told by geometry alone, so that few of many have to be rehearsed.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np
import shapely
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

from pack_core.packing.entry import WayIn, side_of
from pack_core.packing.free_space import footprint
from pack_core.packing.scene import Scene
from pack_core.packing.scene_item import SceneItem
from pack_core.rotations import Array, Pose, tilts
from pack_planner.placement.placement_result import PlacementCandidate

TURNS = np.deg2rad([-20.0, 0.0, 20.0])
"""Angles between the sides to which the best entry and its variations lean [rad]."""
STEEPER = 4.0 / 3.0
"""Half of the random entries are tilted this many times as far, but at most halfway to lying flat."""
FARTHEST = 0.08
"""Largest offset of a random entry's lower end [m]."""
ENTERS_FIRST = 0.02
"""Height of the part of the tilted object that enters first, from its lowest point on [m]."""
Vary = Callable[[PlacementCandidate], list[PlacementCandidate]]
"""Samples feasible placements near a given one."""


def beside(candidate: PlacementCandidate, poses: Mapping[str, Pose], lean: float) -> PlacementCandidate:
    """The candidate leaning towards its obstacles."""
    return replace(candidate, way=WayIn(side_of(candidate.X_WN, candidate.collisions, poses), lean))


def to_every_side(
    candidates: Iterable[PlacementCandidate], poses: Mapping[str, Pose], lean: float, sides: int
) -> list[PlacementCandidate]:
    """Each candidate leaning towards its obstacles, and to this many sides all around."""
    ways = [WayIn(over, lean) for over in _directions(2.0 * np.pi * np.arange(sides) / sides)]
    options: list[PlacementCandidate] = []
    for candidate in candidates:
        options.append(beside(candidate, poses, lean))
        options += [replace(candidate, way=way) for way in ways if candidate.collisions]
    return options


def varied(best: PlacementCandidate, vary: Vary) -> list[PlacementCandidate]:
    """Placements near the best one, which lean to its side and a little to the left and right of it."""
    turns = TURNS if best.way.over.any() else [0.0]
    ways = [replace(best.way, over=_turned(best.way.over, turn)) for turn in turns]
    return [replace(near, way=way) for near in vary(best) for way in ways]


def random_ways(
    candidates: Sequence[PlacementCandidate], lean: float, count: int, rng: np.random.Generator
) -> list[PlacementCandidate]:
    """Random candidates that enter from random sides and offsets, some steeper."""
    chosen = rng.integers(len(candidates), size=count)
    sides = _directions(rng.uniform(0.0, 2.0 * np.pi, count))
    leans = rng.choice([lean, steeper(lean)], count)
    backs = rng.uniform(0.0, FARTHEST, count)
    drawn = zip(chosen.tolist(), sides, leans.tolist(), backs.tolist(), strict=True)
    return [replace(candidates[k], way=WayIn(over, tilt, back)) for k, over, tilt, back in drawn]


def steeper(lean: float) -> float:
    """The larger tilt of random entries [rad], short of lying flat as `lean` is."""
    return min(STEEPER * lean, 0.5 * (lean + 0.5 * np.pi))


def _directions(angles: Array) -> Array:
    """The horizontal unit vectors `(n, 2)` at these angles `(n,)` [rad]."""
    return np.stack([np.cos(angles), np.sin(angles)], axis=1)


def _turned(over: Array, angle: float) -> Array:
    """The horizontal vector `(2,)`, turned by an angle [rad]."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s], [s, c]]) @ over


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
