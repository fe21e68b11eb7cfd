"""The side from which a box comes to its place between others (Sec. 6.3 and 6.4 of the thesis).

Where the thesis leaves room, it is read like this. A direction is admissible when it closes no gap to a box
that is touched at the place. Of the admissible directions the one that opens the most gaps is taken, so that
the box rubs against as few neighbours as possible at the end of its way; corridor length, by which alone
Eq. 6.5 ranks, decides between equals. The pallet's border is no obstacle, since nothing stands beyond it
above the deck.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from pydantic import AfterValidator, Field, NonNegativeFloat, PositiveFloat

from pack_core.config import Config
from pack_core.errors import PackError
from pack_core.palletizing.orders.layout_plan import Insertion
from pack_core.palletizing.orders.order import OrderPallet
from pack_core.palletizing.orders.placed_box import TOUCH, PlacedBox
from pack_core.register import Register
from pack_core.rotations import Array

CENTER = Insertion("Center", np.zeros(3), 0.0)
"""Straight down: the insertion where no side can be used."""
SIDES = {
    "North": (0, 1), "Northeast": (1, 1), "East": (1, 0), "Southeast": (1, -1),
    "South": (0, -1), "Southwest": (-1, -1), "West": (-1, 0), "Northwest": (-1, 1),
}  # fmt: skip
"""The sides that a box may come from: east is the pallet's x axis, north its y axis."""


InsertionRule = Callable[[PlacedBox, Sequence[PlacedBox], "InsertionConfig", OrderPallet], Insertion]
"""Chooses the insertion of a box that comes to its place beside boxes that are placed already, on a pallet;
raises PackError where the box shares space with one of them."""

INSERTION_RULES: Register[InsertionRule] = Register(
    "insertion rule",
    "pack_planner.insertion_rules",
    {"opened_gaps": "pack_planner.layout.insertion_direction:choose_insertion"},
)
"""The rules by their names, the default first."""


class InsertionConfig(Config):
    """Parameters of the direction selection."""

    rule: Annotated[str, AfterValidator(INSERTION_RULES.known)] = Field(
        "opened_gaps", description="which of the admissible sides is taken"
    )
    inflation: NonNegativeFloat = Field(0.01, description="boxes nearer than this count as touched [m]")
    reach: PositiveFloat = Field(0.5, description="corridors are not followed further [m]")
    min_corridor: PositiveFloat = Field(0.02, description="shorter corridors are no use [m]")


@dataclass(frozen=True)
class DirectionCandidate:
    """One of the eight sides, judged.

    Attributes:
        insertion: the insertion from this side.
        opened: number of touched faces whose gap opens on the way out.
        is_admissible: whether it closes no gap and its corridor is long enough.
        directness: sum over the touched faces of the cosine between their outer normal and the way out.
    """

    insertion: Insertion
    opened: int
    is_admissible: bool
    directness: float


def choose_insertion(
    target: PlacedBox, placed: Sequence[PlacedBox], config: InsertionConfig, _: OrderPallet
) -> Insertion:
    """The admissible side with the longest corridor, Eq. 6.5, among those that open the most gaps.

    The result is Center, straight down, where no box is touched or no side is admissible.

    Raises:
        PackError: the target shares space with a placed box.
    """
    usable = [item for item in candidates(target, placed, config) if item.is_admissible and item.opened]
    if not usable:
        return CENTER
    best = max(usable, key=lambda item: (item.opened, round(item.insertion.corridor, 6), item.directness))
    return best.insertion


def candidates(
    target: PlacedBox, placed: Sequence[PlacedBox], config: InsertionConfig
) -> list[DirectionCandidate]:
    """All eight sides, judged for a box that comes to its place beside boxes that are placed already."""
    beside = [item for item in placed if item.is_beside(target)]
    normals = [_normal(target, item) for item in beside if _is_touched(target, item, config)]
    walls = np.unique(np.array(normals).reshape(-1, 2), axis=0)  # several boxes at one side count once
    obstacles = [item for item in beside if not _is_touched(target, item, config)]
    return [
        _candidate(target, name, np.array(side), walls, obstacles, config) for name, side in SIDES.items()
    ]


def _candidate(
    target: PlacedBox,
    name: str,
    side: Array,
    walls: Array,
    obstacles: list[PlacedBox],
    config: InsertionConfig,
) -> DirectionCandidate:
    outward = side / np.linalg.norm(side)
    towards = walls @ outward
    corridor = min(
        [config.reach, *(_distance(target, item, outward, config.inflation) for item in obstacles)]
    )
    is_admissible = bool(np.all(towards < TOUCH)) and corridor >= config.min_corridor
    insertion = Insertion(name, np.append(outward, 0.0), corridor)
    return DirectionCandidate(insertion, int(np.sum(towards < -TOUCH)), is_admissible, -float(towards.sum()))


def _is_touched(target: PlacedBox, other: PlacedBox, config: InsertionConfig) -> bool:
    if target.overlaps(other):
        raise PackError(f"the place of box '{target.id}' overlaps that of '{other.id}'; allowed: free places")
    return bool(np.all(target.clearance(other)[:2] < config.inflation))


def _normal(target: PlacedBox, other: PlacedBox) -> Array:
    """Unit vector `(2,)` from the target towards a box beside it, along the axis that parts them more.

    At a corner with equal gaps, which differ by rounding alone, that is y.
    """
    gaps = target.clearance(other)[:2]
    axis = 0 if gaps[0] > gaps[1] + TOUCH else 1
    normal = np.zeros(2)
    normal[axis] = np.sign((other.centre - target.centre)[axis])
    return normal


def _distance(target: PlacedBox, other: PlacedBox, outward: Array, inflation: float) -> float:
    """How far the target can go before its outline meets the other's, inflated [m]."""
    grown = 0.5 * target.size[:2] + inflation
    return ray_to_rectangle(target.centre[:2], outward, other.lower[:2] - grown, other.upper[:2] + grown)


def ray_to_rectangle(origin: Array, direction: Array, lower: Array, upper: Array) -> float:
    """Length of a ray up to where it enters the open rectangle; infinite where it misses.

    The slab method: for each axis the ray is between the two edges from one length to another, and it is in
    the rectangle where these intervals overlap.

    Args:
        origin: start of the ray `(2,)`.
        direction: unit vector along the ray `(2,)`.
        lower: corner of the rectangle with the smallest coordinates `(2,)`.
        upper: the opposite corner `(2,)`.
    """
    enter, leave = 0.0, np.inf
    for p, d, low, high in zip(origin, direction, lower, upper, strict=True):
        if d == 0.0:  # parallel to the slab: either always inside it or never
            if not low < p < high:
                return np.inf
            continue
        first, second = sorted(((low - p) / d, (high - p) / d))
        enter, leave = max(enter, float(first)), min(leave, float(second))
    return enter if enter < leave else np.inf
