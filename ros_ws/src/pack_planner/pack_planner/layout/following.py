"""A box moves with the boxes that it rests on, by the share of its carried base that lies on each."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pack_core.palletizing.orders.placed_box import PlacedBox
from pack_core.rotations import Array


def support_shares(boxes: Sequence[PlacedBox]) -> Array:
    """Share of each box's carried base that lies on each other box `(n, n)`; rows of zeros on the deck."""
    areas = np.array([[_shared_area(upper, lower) for lower in boxes] for upper in boxes])
    totals = areas.sum(axis=1, keepdims=True)
    return np.asarray(areas / np.where(totals > 0.0, totals, 1.0))  # rows without support stay zero


def _shared_area(upper: PlacedBox, lower: PlacedBox) -> float:
    # Both clearances are negative overlaps here, so that their product is the shared area.
    return float(np.prod(upper.clearance(lower)[:2])) if upper.rests_on(lower) else 0.0
