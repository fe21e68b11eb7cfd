"""The insertion direction of the thesis, Eq. 6.5 as printed: of the admissible ones the longest corridor."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pack_core.palletizing.orders.layout_plan import Insertion
from pack_core.palletizing.orders.order import OrderPallet
from pack_core.palletizing.orders.placed_box import PlacedBox
from pack_core.rotations import Array
from pack_planner.layout.insertion_direction import CENTER, InsertionConfig, candidates


def longest_corridor(
    target: PlacedBox, placed: Sequence[PlacedBox], config: InsertionConfig, pallet: OrderPallet
) -> Insertion:
    """The admissible side with the longest corridor; Center where no box is touched or no side is admissible.

    Corridors end at neighbours and at the pallet's border (Sec. 6.4), whichever comes first. Of equally long
    ones the most direct one is taken, which the thesis leaves open.

    Raises:
        PackError: the target shares space with a placed box.
    """
    sides = candidates(target, placed, config)
    found = [
        (min(item.insertion.corridor, _to_border(target, item.insertion.outward[:2], pallet)), item)
        for item in sides
        if item.is_admissible
    ]
    is_touched = any(item.opened for item in sides)  # of two opposite sides one opens the gap to a neighbour
    if not (found and is_touched):
        return CENTER
    length, best = max(found, key=lambda pair: (round(pair[0], 6), pair[1].directness))
    return Insertion(best.insertion.direction, best.insertion.outward, length)


def _to_border(target: PlacedBox, outward: Array, pallet: OrderPallet) -> float:
    """Length of the ray from the box's centre to the pallet's border along a unit vector `(2,)` [m]."""
    size, centre = np.array([pallet.length, pallet.width]), target.centre[:2]
    ends = np.where(outward > 0.0, size - centre, centre)
    is_along = np.abs(outward) > 0.0
    return float(np.min(ends[is_along] / np.abs(outward[is_along])))
