"""The cheapest turn that brings a box, as it arrives, to wanted extents on the pallet."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import permutations
from typing import get_args

from pack_core.palletizing.orders.handling import (
    ARRIVAL,
    BundlingAxis,
    Extents,
    Handling,
    OrientId,
    turn_of,
)

PRICE = {Handling.NONE: 0, Handling.FLIP: 1, Handling.TABLE: 2}
"""What a turn costs against others: standing a box up on table B takes twice the time of a whole cycle."""


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
