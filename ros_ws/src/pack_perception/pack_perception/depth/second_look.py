"""A look while objects are pushed: what was hidden, and what is seen better than before.

All but what is sure already is looked at as at the first time. What overlaps with an object that is known is
that object, seen again: its shape is taken if it is surer, or if it goes on where the known one ends, since
what was seen is there. What overlaps with none is an object that nobody had seen, or one that was lost: it
has its size, and cameras see through the place where that is believed to be. All are believed once two looks
in a row agree, as leaning objects and the arm's edges look like others for a moment.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from scipy.optimize import linear_sum_assignment

from pack_core.packing.free_space import footprint
from pack_core.packing.scene import Scene
from pack_core.packing.scene_item import SceneItem
from pack_core.packing.seen_deviations import SeenDeviations
from pack_core.rotations import Array, Pose, rotate
from pack_perception.depth.look import SeenShape
from pack_perception.depth.sight_lines import SightLines
from pack_perception.perception_config import LookAgainConfig

SAME = 0.5
"""Overlap of outlines, intersection over union, from which two are of one object."""
MORE = 0.1
"""Share of a known outline that another one has beyond it if it goes on there, and that it may lack."""
APART = 0.1
"""Share of an outline that may be within others of an object that nobody had seen."""
INNER = (0.4, 0.7)
"""Where points within a body are, in shares of the way from its middle to its corners."""
SEEN_THROUGH = 0.3
"""Share of these points that cameras see through if the body is elsewhere."""
ALIKE = 0.015
"""What is found may be a lost object if none of its lengths differs by more [m]."""


@dataclass(frozen=True)
class KnownObject:
    """An object as it is known.

    Attributes:
        item: its shape.
        X_WO: where it is estimated to be.
        deviations: how sure its shape is; None where it never was looked at, so that its shape stays.
        is_lost: whether it is not there: cameras saw through the place.
    """

    item: SceneItem
    X_WO: Pose
    deviations: SeenDeviations | None
    is_lost: bool = False

    def may_be_replaced(self, config: LookAgainConfig) -> bool:
        """Whether a look may know its shape better: it stands upright, and a length is not sure."""
        # a capsule that lies has no upper side: it may have rolled
        up = rotate(self.item.standing(self.X_WO).q, np.array([0.0, 0.0, 1.0]))[2]
        is_upright = up > np.cos(np.deg2rad(config.tilt_deg))
        return self.deviations is not None and is_upright and max(self.deviations.size[:2]) > config.sure


@dataclass(frozen=True)
class LookFinding:
    """What a look has found of an object.

    Attributes:
        fit: its shape, and where.
        name: of the known object that it is; None: of none.
    """

    fit: SeenShape
    name: str | None

    def agrees(self, other: LookFinding) -> bool:
        """Whether both are of one object at one place."""
        return self.name == other.name and overlap_of(_outline(self.fit), _outline(other.fit)) > SAME


class SecondLooks:
    """When to look again, and what to believe of it; it remembers the last look.

    Args:
        config: parameters.
    """

    def __init__(self, config: LookAgainConfig) -> None:
        self._config = config
        self.start_over()

    def start_over(self) -> None:
        """Forget all looks, as after a reset."""
        self._time, self._places = -np.inf, dict[str, Array]()
        self._unconfirmed: list[LookFinding] = []

    def note(self, time: float, places: Mapping[str, Array]) -> None:
        """Remember when it was looked [s], and where objects were then: positions `(3,)` [m] by name."""
        self._time, self._places = time, dict(places)

    def is_worth_it(self, time: float, places: Mapping[str, Array]) -> bool:
        """Whether another look may show more than the last one; time [s] and places as in `note`."""
        if time - self._time < self._config.period:
            return False
        return bool(self._unconfirmed) or have_moved(places, self._places, self._config)

    def sure(self, known: Sequence[KnownObject]) -> list[shapely.Polygon]:
        """Outlines of objects that are not looked for, as no look can know them better."""
        stay = [one for one in known if not one.is_lost and not one.may_be_replaced(self._config)]
        return [footprint(one.item, one.X_WO) for one in stay]

    def believed(self, found: Sequence[SeenShape], known: Sequence[KnownObject]) -> dict[str, SeenShape]:
        """What this look and the last one have both found: by the names of known objects, or by their own."""
        now = findings(found, known, self._config)
        taken = confirmed(now, self._unconfirmed)
        self._unconfirmed = [] if taken else now
        return {finding.name or finding.fit.item.name: finding.fit for finding in taken}


def with_shapes(scene: Scene, fits: Mapping[str, SeenShape]) -> Scene:
    """A scene whose objects have other shapes, by name, and their own names and colours; others are new."""
    shapes = {name: fit.item for name, fit in fits.items()}
    known = [
        shapes.pop(one.name).model_copy(update={"name": one.name, "colour": one.colour})
        if one.name in shapes
        else one
        for one in scene.objects
    ]
    return scene.model_copy(update={"objects": [*known, *shapes.values()]})


def findings(
    found: Sequence[SeenShape], known: Sequence[KnownObject], config: LookAgainConfig
) -> list[LookFinding]:
    """Those of `found` that are of no known object, or know one better, or are one that was lost."""
    there, lost = [one for one in known if not one.is_lost], [one for one in known if one.is_lost]
    outlines = [footprint(one.item, one.X_WO) for one in there]
    results, beside = [], []
    for fit in found:
        outline = _outline(fit)
        overlaps = [overlap_of(outline, other) for other in outlines]
        best = int(np.argmax(overlaps)) if overlaps else -1
        if best >= 0 and overlaps[best] > SAME:
            is_better = is_surer(fit, there[best], config) or goes_on(outline, outlines[best])
            if is_better and there[best].may_be_replaced(config):
                results.append(LookFinding(fit, there[best].item.name))
        elif outline.intersection(shapely.union_all(outlines)).area < APART * outline.area:
            beside.append(fit)
    names = which_is_which([fit.item for fit in beside], [one.item for one in lost])
    return [*results, *map(LookFinding, beside, names)]


def which_is_which(found: Sequence[SceneItem], lost: Sequence[SceneItem]) -> list[str | None]:
    """Which of the lost objects each of `found` is, by its lengths, whichever of them is upright; or none."""
    if not found or not lost:
        return [None] * len(found)
    lengths = [np.sort([2.0 * item.half_extents for item in items]) for items in (found, lost)]
    apart = np.abs(lengths[0][:, None] - lengths[1]).max(axis=2)
    names: list[str | None] = [None] * len(found)
    rows, columns = linear_sum_assignment(apart)
    for i, j in zip(rows.tolist(), columns.tolist(), strict=True):
        if apart[i, j] < ALIKE:
            names[i] = lost[j].name
    return names


def is_seen_through(item: SceneItem, X_WO: Pose, sight: SightLines) -> bool:
    """Whether cameras saw through so much of a body's inside that it is not at X_WO."""
    inside = np.concatenate([share * item.hull() for share in INNER])
    return bool(np.mean(sight.is_free(X_WO.apply(inside))) > SEEN_THROUGH)


def confirmed(now: Sequence[LookFinding], before: Sequence[LookFinding]) -> list[LookFinding]:
    """Those findings with which the look before agrees."""
    return [finding for finding in now if any(finding.agrees(other) for other in before)]


def is_surer(fit: SeenShape, known: KnownObject, config: LookAgainConfig) -> bool:
    """Whether the lengths of what was found are surer than those that are known, altogether."""
    return known.deviations is not None and sum(fit.deviations.size[:2]) < config.surer * sum(
        known.deviations.size[:2]
    )


def goes_on(outline: shapely.Polygon, known: shapely.Polygon) -> bool:
    """Whether an outline covers a known one, and clearly more."""
    both = outline.intersection(known).area
    return bool(both > (1.0 - MORE) * known.area and outline.area - both > MORE * known.area)


def overlap_of(one: shapely.Polygon, other: shapely.Polygon) -> float:
    """Intersection of two outlines over their union."""
    return float(one.intersection(other).area / one.union(other).area)


def have_moved(poses: Mapping[str, Array], before: Mapping[str, Array], config: LookAgainConfig) -> bool:
    """Whether any object is elsewhere than before; both are positions `(3,)` [m] by name."""
    return any(
        name not in before or np.linalg.norm(p - before[name]) > config.moved for name, p in poses.items()
    )


def _outline(fit: SeenShape) -> shapely.Polygon:
    return footprint(fit.item, fit.X_WO)
