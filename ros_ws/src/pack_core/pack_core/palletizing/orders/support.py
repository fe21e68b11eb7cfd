"""Static stability of a box: the share of its base that is carried, and the margin of its centre of mass."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from pydantic import Field, NonNegativeFloat
from shapely import MultiPolygon, Point, Polygon, box

from pack_core.config import Config
from pack_core.palletizing.orders.placed_box import TOUCH, PlacedBox

ROUNDING = 1e-7
"""By which the share of a base may be smaller than is needed: what computing leaves of sums."""


class SupportConfig(Config):
    """The support that every box must have."""

    min_share: float = Field(0.7, ge=0, le=1, description="of a box's base that must be carried")
    min_margin: NonNegativeFloat = Field(
        0.01, description="distance of the centre of mass from the edge of what carries the box [m]"
    )


@dataclass(frozen=True)
class Support:
    """The support of one box.

    Attributes:
        id: name of the box.
        share: share of its base that lies on the deck or on other boxes, 0 to 1.
        margin: distance of its centre of mass, seen from above, from the edge of the convex hull of all
            surfaces that carry it [m]; negative outside.
    """

    id: str
    share: float
    margin: float

    def problem(self, config: SupportConfig) -> str | None:
        """Why the box would not stay at its place, in words; None where it would."""
        if self.share < config.min_share - ROUNDING:
            return f"{self.share:.1%} of its base is carried; allowed: at least {config.min_share:.0%}"
        if self.margin < config.min_margin:
            where = "inside" if self.margin >= 0.0 else "outside"
            return (
                f"its centre of mass is {abs(self.margin) * 1e3:.0f} mm {where} of what carries it; "
                f"allowed: at least {config.min_margin * 1e3:.0f} mm inside"
            )
        return None


def support_of(item: PlacedBox, others: Sequence[PlacedBox]) -> Support:
    """The support of a box on the deck or on top of other boxes."""
    base = _footprint(item)
    if item.lower[2] < TOUCH:
        patches = [base]
    else:
        patches = [base.intersection(_footprint(other)) for other in others if item.rests_on(other)]
    if not patches:
        return Support(item.id, 0.0, -float("inf"))
    carrying = MultiPolygon(patches)
    hull, centre = carrying.convex_hull, Point(item.centre[:2])
    margin = hull.exterior.distance(centre) * (1.0 if hull.contains(centre) else -1.0)
    return Support(item.id, carrying.area / base.area, margin)


def unstable_boxes(boxes: Sequence[PlacedBox], config: SupportConfig) -> dict[str, str]:
    """The names of the boxes that would not stay at their place, and the reason for each."""
    tops = np.array([other.upper[2] for other in boxes])
    problems = {}
    for item in boxes:
        # only boxes whose tops are at its base can carry it; `support_of` looks at the rest
        level = np.flatnonzero(np.abs(tops - item.lower[2]) < 2 * TOUCH).tolist()
        problems[item.id] = support_of(item, [boxes[k] for k in level]).problem(config)
    return {name: problem for name, problem in problems.items() if problem is not None}


def _footprint(item: PlacedBox) -> Polygon:
    return box(*item.lower[:2], *item.upper[:2])
