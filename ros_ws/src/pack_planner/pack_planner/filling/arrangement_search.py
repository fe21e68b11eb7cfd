"""Arrangements of outlines by corner placement: one after the other into a corner of its free places."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import shapely

from pack_core.packing.objects import ObjectModel
from pack_core.rotations import Array
from pack_planner.filling.free_places import FreePlaces, NoFitPolygons, Outline, PlacedOutline

Order = tuple[str, ...]


@dataclass
class Arranged:
    """An arrangement: its worth [m^2], and what has a place in it."""

    worth: float = 0.0
    placed: dict[str, PlacedOutline] = field(default_factory=dict)


class ArrangementSearch:
    """Tries orders and directions.

    Args:
        items: what is to be put down.
        standing: what stands there already.
        bonus: what an object more is worth, whatever its size [m^2].
        shuffle: how far tries depart from the largest-first order, as share of an area.
    """

    def __init__(
        self, items: Sequence[ObjectModel], standing: Sequence[PlacedOutline], bonus: float, shuffle: float
    ) -> None:
        self._standing, self._bonus, self._shuffle = standing, bonus, shuffle
        same: dict[tuple[bytes, float], list[Outline]] = {}
        self._sides = {
            item.name: same.setdefault((item.hull().tobytes(), item.symmetry), _sides(item)) for item in items
        }
        self._areas = np.array([self._sides[item.name][0].area for item in items])

    @property
    def most(self) -> float:
        """What an arrangement of everything would be worth [m^2]."""
        return float(np.sum(self._areas + self._bonus))

    def best(
        self, no_fit: NoFitPolygons, tries: int, rng: np.random.Generator, enough: float | None = None,
        names: frozenset[str] | None = None,
    ) -> Arranged:  # fmt: skip
        """The arrangement of the largest worth.

        Args:
            no_fit: the container with its gaps.
            tries: how many are tried.
            rng: source of the variations.
            enough: worth at which the search ends [m^2]; None: that of everything.
            names: what is to be put down; None: everything.
        """
        start, best = FreePlaces(no_fit), Arranged()
        start.put(self._standing)
        for k in range(tries):
            order = [name for name in self._order(k, rng) if names is None or name in names]
            found = self._try(FreePlaces(no_fit, start), order, _direction(rng))
            best = max(best, found, key=lambda arranged: arranged.worth)
            if best.worth > (self.most if enough is None else enough) - 1e-9:
                break
        return best

    def _order(self, k: int, rng: np.random.Generator) -> list[str]:
        """Try 0 has the largest first, odd ones vary that, and even ones are quite random."""
        names, count = list(self._sides), len(self._sides)
        if k and k % 2 == 0:
            return [names[i] for i in rng.permutation(count)]
        spread = self._shuffle if k else 0.0
        keys = -self._areas * (1.0 + spread * rng.uniform(-1.0, 1.0, count))
        return [names[i] for i in np.argsort(keys, kind="stable")]

    def _try(self, free: FreePlaces, order: Sequence[str], way: Array) -> Arranged:
        found = Arranged()
        for name in order:
            placed = _corner(free, self._sides[name], way)
            if placed is not None:
                found.worth += placed.outline.area + self._bonus
                found.placed[name] = placed
                free.put([placed])
        return found


def _direction(rng: np.random.Generator) -> Array:
    """How corners are preferred `(2,)`: far along x or along y, towards one side of each."""
    return np.asarray(rng.choice([-1.0, 1.0], 2) * rng.permutation([1.0, rng.uniform(0.05, 0.5)]))


def _corner(free: FreePlaces, sides: Sequence[Outline], way: Array) -> PlacedOutline | None:
    """The place farthest along `way` `(2,)`, at the better of an object's yaws; None without room."""
    best, farthest = None, -np.inf
    for outline in sides:
        corners = shapely.get_coordinates(free.of(outline))
        if not len(corners):
            continue
        # how far the outline's near side is: against a wall the far sides of both yaws reach equally far
        reach = corners @ way - np.abs(way) @ np.ptp(outline.corners, axis=0) / 2.0
        k = int(np.argmax(reach))
        if reach[k] > farthest:
            best, farthest = PlacedOutline(outline, corners[k]), float(reach[k])
    return best


def _sides(item: ObjectModel) -> list[Outline]:
    """The outlines at the yaws that are tried: along the walls, both ways where these differ."""
    turns = {0.0: [0.0], np.pi: [0.0, np.pi / 2], 2 * np.pi: [0.0, np.pi / 2, np.pi, 3 * np.pi / 2]}
    yaws = next((turns[s] for s in turns if np.isclose(item.symmetry, s)), [0.0])
    return [Outline.of(item, yaw) for yaw in yaws]
