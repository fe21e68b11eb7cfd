"""The turn from a box's orientation on arrival to its orientation on the pallet, and the handling it needs.

Chapter 5 of the thesis names an orientation by `orient_id` and `bundling_axis`. Its bypass rules leave one
consistent reading: the planner's triple (l, w, h) is (d_x, d_y, d_z) with bundling axis z and (d_x, d_z, d_y)
with y, and `orient_id` is a fixed permutation of it. The thesis prints ids 1 and 3 twice or upside down: they
are given the two orientations that would be missing otherwise.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from itertools import permutations
from typing import Literal, get_args

OrientId = Literal[0, 1, 2, 3, 4, 5]
BundlingAxis = Literal["z", "y"]
Extents = tuple[float, float, float]

PERMUTATIONS: dict[OrientId, tuple[int, int, int]] = {
    0: (0, 1, 2),
    1: (1, 2, 0),
    2: (2, 0, 1),
    3: (2, 1, 0),
    4: (1, 0, 2),
    5: (0, 2, 1),
}
"""Which of l, w and h lie along the pallet's x, y and z."""

ARRIVAL: dict[BundlingAxis, tuple[int, int, int]] = {"z": (0, 1, 2), "y": (0, 2, 1)}
"""Which of d_x, d_y and d_z are l, w and h."""


class Handling(StrEnum):
    """How a box must be turned on its way to the pallet."""

    NONE = "none"
    FLIP = "flip"
    TABLE = "table"


PRICE = {Handling.NONE: 0.0, Handling.FLIP: 0.05, Handling.TABLE: 1.0}
"""What a turn costs against others: a quarter turn in flight takes half a second, standing a box up on table
B nine and a half."""


@dataclass(frozen=True)
class Turn:
    """From the way a box arrives, d_x along the world's x and d_z up, to the way it stands on the pallet.

    Attributes:
        handling: how it is done: not at all, by a quarter turn in flight, or by standing it up on the table.
        extents: of the box on the pallet along x, y and z [m].
    """

    handling: Handling
    extents: Extents


def turn_of(dims: Extents, axis: BundlingAxis, orient_id: OrientId) -> Turn:
    """The turn a box needs; where sides are equal, the cheapest that gives the same extents."""
    i, j, k = (ARRIVAL[axis][n] for n in PERMUTATIONS[orient_id])
    extents = dims[i], dims[j], dims[k]
    if extents == dims:
        return Turn(Handling.NONE, extents)
    turned = dims[1], dims[0], dims[2]
    return Turn(Handling.FLIP if extents == turned else Handling.TABLE, extents)


@dataclass(frozen=True)
class TurnChoice:
    """How an order names a turn, and what it takes."""

    orient_id: OrientId
    bundling_axis: BundlingAxis
    handling: Handling
    extents: Extents


def turns_of(size: Extents, *, this_side_up: bool) -> tuple[TurnChoice, ...]:
    """The turns to every distinct extents that a box may have on the pallet, the cheapest first.

    Args:
        size: length, width and height of the box [m].
        this_side_up: whether the height stays upright.
    """
    d_x, d_y, d_z = sorted(size, reverse=True)  # a box arrives on its largest face
    upright = {size[2]} if this_side_up else set(size)
    wanted = {extents for extents in permutations(size) if extents[2] in upright}
    found: dict[Extents, TurnChoice] = {}
    for axis in ARRIVAL:
        for orient_id in get_args(OrientId):
            turn = turn_of((d_x, d_y, d_z), axis, orient_id)
            choice = TurnChoice(orient_id, axis, turn.handling, turn.extents)
            best = found.get(turn.extents)
            if turn.extents in wanted and (best is None or PRICE[choice.handling] < PRICE[best.handling]):
                found[turn.extents] = choice
    return tuple(sorted(found.values(), key=lambda choice: PRICE[choice.handling]))
