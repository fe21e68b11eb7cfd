"""Arranges the objects of a list in what is left of a container, seen from above.

Objects are put down one after the other, the larger ones first, each into the corner of its free places that
is farthest to one side. Many such arrangements are tried, with other sides and other orders. The one that
covers most of the base is taken, where an object more is worth some area. The lowest of its objects comes
first, so that neither the pump nor a held object has to go down beside something that is taller.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
import shapely

from pack_core.packing.free_space import footprint
from pack_core.packing.objects import ObjectModel
from pack_core.packing.scene import Container
from pack_core.rotations import Array, Pose, from_yaw
from pack_planner.filling.arrangement_config import ArrangementConfig
from pack_planner.filling.outline import Outline

GAIN = 0.02
"""Share of the base by which another arrangement must cover more than the one that is kept."""
NO_ROOM = "no room for it is left on the base"


@dataclass
class _Try:
    """One arrangement: its worth [m^2], and X_WO of the objects that have a place."""

    worth: float = 0.0
    poses: dict[str, Pose] = field(default_factory=dict)
    is_kept: bool = False


class ArrangementPlanner:
    """Plans where the remaining objects of a list shall stand.

    Args:
        config: parameters.
        gap: distance between objects [m].
        wall_gap: distance to the walls [m].
    """

    def __init__(self, config: ArrangementConfig, gap: float, wall_gap: float) -> None:
        self._config, self._gap, self._wall_gap = config, gap, wall_gap
        self._bonus = 0.0

    def plan(
        self, container: Container, taken: Sequence[Array], items: Sequence[ObjectModel],
        rng: np.random.Generator, planned: Mapping[str, Pose],
    ) -> Mapping[str, Pose]:  # fmt: skip
        """Upright poses X_WO of those objects that find a place.

        Args:
            container: what is filled.
            taken: corners `(n, 2)` of the outlines of what stands there already [m].
            items: the objects, without poses.
            rng: source of the variations.
            planned: poses X_WO of an earlier arrangement, which is kept unless another covers more.
        """
        outlines = {item.name: _outlines(item) for item in items}
        self._bonus = self._config.object_worth * float(np.prod(container.size))
        wanted = sum(sides[0].area + self._bonus for sides in outlines.values())
        best = self._kept(container, taken, items, planned)
        for k in range(self._config.tries):
            found = self._try(container, list(taken), items, outlines, rng, is_first=k == 0)
            if found.worth > best.worth + (GAIN * np.prod(container.size) if best.is_kept else 0.0):
                best = found
            if best.worth > wanted - 1e-9:
                break
        return best.poses

    def _kept(
        self, container: Container, taken: Sequence[Array], items: Sequence[ObjectModel],
        planned: Mapping[str, Pose],
    ) -> _Try:  # fmt: skip
        """What is left of an earlier arrangement, without objects whose places are taken by now."""
        found = _Try(is_kept=True)
        standing = shapely.union_all([shapely.Polygon(corners) for corners in taken])
        for item in items:
            if (X_WO := planned.get(item.name)) is None:
                continue
            outline = footprint(item, X_WO)
            if not outline.buffer(-self._config.yielding).intersects(standing):
                found.worth += float(outline.area) + self._bonus
                found.poses[item.name] = X_WO
        return found

    def _try(
        self, container: Container, taken: list[Array], items: Sequence[ObjectModel],
        outlines: Mapping[str, Sequence[Outline]], rng: np.random.Generator, *, is_first: bool,
    ) -> _Try:  # fmt: skip
        found = _Try()
        sizes = np.array([outlines[item.name][0].area for item in items])
        spread = 0.0 if is_first else self._config.shuffle
        # the way in which corners are preferred: far along x or along y, towards one side of each
        way = rng.choice([-1.0, 1.0], 2) * rng.permutation([1.0, rng.uniform(0.05, 0.5)])
        for i in np.argsort(-sizes * (1.0 + spread * rng.uniform(-1.0, 1.0, len(sizes)))):
            item = items[int(i)]
            placed = self._place(container, taken, outlines[item.name], way)
            if placed is not None:
                outline, xy = placed
                found.worth += outline.area + self._bonus
                p_WO = np.array([*xy, item.half_extents[2]])
                found.poses[item.name] = Pose(p_WO, from_yaw(outline.yaw))
                taken.append(outline.at(xy))
        return found

    def _place(
        self, container: Container, taken: list[Array], sides: Sequence[Outline], way: Array
    ) -> tuple[Outline, Array] | None:
        """The place farthest along `way` `(2,)`, at the better of an object's yaws; None without room."""
        best: tuple[float, Outline, Array] | None = None
        for outline in sides:
            room = outline.room(container, taken, self._gap, self._wall_gap)
            if room.is_empty:
                continue
            corners = shapely.get_coordinates(room)
            # how far the outline's far side reaches, so that both yaws compare
            reach = corners @ way + np.abs(way) @ np.ptp(outline.corners, axis=0) / -2.0
            k = int(np.argmax(reach))
            if best is None or reach[k] > best[0]:
                best = float(reach[k]), outline, corners[k]
        return None if best is None else best[1:]


def _outlines(item: ObjectModel) -> list[Outline]:
    """The outlines at the yaws that are tried: along the walls, both ways where these differ."""
    turns = {0.0: [0.0], np.pi: [0.0, np.pi / 2], 2 * np.pi: [0.0, np.pi / 2, np.pi, 3 * np.pi / 2]}
    yaws = next((turns[s] for s in turns if np.isclose(item.symmetry, s)), [0.0])
    return [Outline.of(item, yaw) for yaw in yaws]
