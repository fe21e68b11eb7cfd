"""Arranges the objects of a list in what is left of a container, seen from above.

Many arrangements are tried (`arrangement_search.py`), and the one that covers most of the base is taken,
where an object more is worth some area. If there is room to spare, it is arranged again with wider gaps:
what has more room around it touches less on its way down.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import ClassVar

import numpy as np
import shapely
from pydantic import Field, NonNegativeFloat, PositiveInt

from pack_core.config import NEXT_REQUEST, Changeable, Config
from pack_core.packing.free_space import footprint
from pack_core.packing.objects import ObjectModel
from pack_core.packing.scene import Container
from pack_core.packing.scene_item import SceneItem
from pack_core.rotations import Pose, from_yaw
from pack_planner.filling.arrangement_search import Arranged, ArrangementSearch
from pack_planner.filling.free_places import NoFitPolygons, Outline, PlacedOutline

NO_ROOM = "no room for it is left on the base"


class ArrangementConfig(Config):
    """How many arrangements are tried, and how close objects may stand."""

    changeable: ClassVar[Changeable] = NEXT_REQUEST

    tries: PositiveInt = Field(default=400, description="arrangements that are tried")
    tries_again: PositiveInt = Field(default=40, description="and that are tried where one is known already")
    gap: NonNegativeFloat = Field(default=0.002, description="gap between objects [m]")
    wall_gap: NonNegativeFloat = Field(default=0.003, description="gap to the walls [m]")
    free_gap: NonNegativeFloat = Field(
        default=0.012, description="gap to everything where contact is to be avoided [m]"
    )
    object_worth: NonNegativeFloat = Field(
        default=0.1, description="share of the base that an object more is worth, whatever its size"
    )
    yielding: NonNegativeFloat = Field(
        default=0.006, description="overlap with what stands there by now at which a place is kept [m]"
    )
    shuffle: NonNegativeFloat = Field(
        default=0.8, description="how far tries depart from the largest-first order, as share of an area"
    )
    gain: NonNegativeFloat = Field(
        default=0.02,
        description="share of the base by which another arrangement must cover more than the one known",
    )
    wider: float = Field(default=1.5, gt=1, description="factor from one gap that is tried to the next")


class ArrangementPlanner:
    """Plans where the remaining objects of a list shall stand.

    Args:
        config: parameters.
        gap: distance between objects [m].
        wall_gap: distance to the walls [m].
    """

    def __init__(self, config: ArrangementConfig, gap: float, wall_gap: float) -> None:
        self._config, self._gap, self._wall_gap = config, gap, wall_gap

    def plan(
        self, container: Container, standing: Sequence[tuple[SceneItem, Pose]], items: Sequence[ObjectModel],
        rng: np.random.Generator, planned: Mapping[str, Pose],
    ) -> Mapping[str, Pose]:  # fmt: skip
        """Upright poses X_WO of those objects that find a place.

        Args:
            container: what is filled.
            standing: what stands there already, at X_WO.
            items: the objects, without poses.
            rng: source of the variations.
            planned: poses X_WO of an earlier arrangement, which is kept unless another covers more.
        """
        config, base = self._config, float(np.prod(container.size))
        there = [PlacedOutline(Outline.standing(item, X_WO), X_WO.p[:2]) for item, X_WO in standing]
        bonus = config.object_worth * base
        search = ArrangementSearch(items, there, bonus, config.shuffle)
        wanted = {item.name: planned[item.name] for item in items if item.name in planned}
        kept = self._kept(standing, items, wanted)
        if len(kept) == len(items):
            return kept
        is_whole = bool(wanted) and len(kept) == len(wanted)
        tries = config.tries_again if is_whole else config.tries
        found = search.best(NoFitPolygons(container, self._gap, self._wall_gap), tries, rng)
        worth = sum(
            float(footprint(item, kept[item.name]).area) + bonus for item in items if item.name in kept
        )
        if kept and found.worth <= worth + config.gain * base:
            return kept
        found = self._widened(container, search, found, rng)
        heights = {item.name: float(item.half_extents[2]) for item in items}
        return {
            name: Pose(np.array([*placed.xy, heights[name]]), from_yaw(placed.outline.yaw))
            for name, placed in found.placed.items()
        }

    def could_fit(self, container: Container, items: Sequence[ObjectModel], rng: np.random.Generator) -> bool:
        """Whether some arrangement without any gaps has all objects, were they free to move aside."""
        # all have to fit, so that an object counts more than any area
        bonus = float(np.prod(container.size))
        search = ArrangementSearch(items, (), bonus, self._config.shuffle)
        found = search.best(NoFitPolygons(container, 0.0, 0.0), self._config.tries, rng)
        return len(found.placed) == len(items)

    def _kept(
        self, standing: Sequence[tuple[SceneItem, Pose]], items: Sequence[ObjectModel],
        planned: Mapping[str, Pose],
    ) -> dict[str, Pose]:  # fmt: skip
        """What is left of an earlier arrangement, without objects whose places are taken by now."""
        taken = shapely.union_all([footprint(item, X_WO) for item, X_WO in standing])
        return {
            item.name: X_WO
            for item in items
            if (X_WO := planned.get(item.name)) is not None
            and not footprint(item, X_WO).buffer(-self._config.yielding).intersects(taken)
        }

    def _widened(
        self, container: Container, search: ArrangementSearch, found: Arranged, rng: np.random.Generator
    ) -> Arranged:
        """The same objects with the widest gap at which all of them still find a place."""
        config = self._config
        gap = self._gap * config.wider
        names = frozenset(found.placed)
        while 0.0 < gap < config.free_gap + 1e-9:  # no factor widens a gap of zero
            no_fit = NoFitPolygons(container, gap, max(self._wall_gap, gap))
            wider = search.best(no_fit, config.tries_again, rng, found.worth, names)
            if len(wider.placed) < len(names):
                break
            found, gap = wider, gap * config.wider
        return found
