"""What a round of rehearsals tries: placements, each with ways in."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from pack_core.packing.entry import WayIn, side_of
from pack_core.rotations import Array, Pose
from pack_planner.placement.placement_result import PlacementCandidate

TURNS = np.deg2rad([-20.0, 0.0, 20.0])
"""Angles between the sides to which the best entry and its variations lean [rad]."""
STEEPER = 4.0 / 3.0
"""Half of the random entries are tilted this many times as far, but at most halfway to lying flat."""
FARTHEST = 0.08
"""Largest offset of a random entry's lower end [m]."""
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
