"""The placement margin algorithm of the thesis (Sec. 6.2): the pairs of a layer are corrected one by one."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

import numpy as np

from pack_core.palletizing.orders.layout_plan import layers_of
from pack_core.palletizing.orders.order import OrderPallet
from pack_core.palletizing.orders.placed_box import TOUCH, PlacedBox
from pack_core.rotations import Array
from pack_planner.layout.pallet_separator import Separation, SeparatorConfig, smallest_gap, support_shares

SWEEPS = 200
"""Most passes over the pairs of a layer. A correction may close the gap to a third box, so that passes are
repeated; the thesis states no number."""


class PairwiseSeparator:
    """Makes gaps in layouts for one kind of pallet."""

    def __init__(self, pallet: OrderPallet, config: SeparatorConfig) -> None:
        self._size, self._config = np.array([pallet.length, pallet.width]), config

    def separate(self, boxes: Sequence[PlacedBox], gap: float | None = None) -> Separation:
        """Part the boxes by `gap` [m]; None: by the configured gap.

        Where the pallet is too small, a virtual margin around it grows in steps. Boxes of different layers
        are not parted, although they may overlap in height.
        """
        wanted = self._config.gap if gap is None else gap
        steps = round(self._config.max_margin / self._config.margin_step)
        for margin in self._config.margin_step * np.arange(steps + 1):
            shifts = self._shifts(boxes, wanted, float(margin))
            if shifts is not None:
                moved = tuple(item.moved([*shift, 0.0]) for item, shift in zip(boxes, shifts, strict=True))
                return Separation(moved, shifts, smallest_gap(moved), float(margin), True, False)
        still = np.zeros((len(boxes), 2))
        return Separation(tuple(boxes), still, smallest_gap(boxes), self._config.max_margin, False, False)

    def _shifts(self, boxes: Sequence[PlacedBox], gap: float, margin: float) -> Array | None:
        """Displacements `(n, 2)` [m] that part every layer; None where a pair cannot be parted.

        From the deck upwards each layer follows what carries it, so that stacks stay aligned, and is parted
        then.
        """
        shifts, follow = np.zeros((len(boxes), 2)), support_shares(boxes)
        places = {item.id: k for k, item in enumerate(boxes)}
        for layer in layers_of(boxes):
            members = [places[item.id] for item in layer]
            shifts[members] = follow[members] @ shifts
            if not self._part(boxes, members, shifts, gap, margin):
                return None
        return shifts

    def _part(
        self, boxes: Sequence[PlacedBox], members: Sequence[int], shifts: Array, gap: float, margin: float
    ) -> bool:
        """Correct the conflicting pairs of a layer until there is none; whether that was possible."""
        lower, upper = (np.array([getattr(item, end)[:2] for item in boxes]) for end in ("lower", "upper"))
        for _ in range(SWEEPS):
            is_parted = True
            for i, j in combinations(members, 2):
                clear = np.maximum(lower[i] + shifts[i] - upper[j] - shifts[j],
                                   lower[j] + shifts[j] - upper[i] - shifts[i])  # fmt: skip
                missing = np.maximum(0.0, gap - clear)  # Eq. 6.1
                if np.any(missing < TOUCH):  # enough along one axis
                    continue
                is_parted = False
                if not self._correct(lower, upper, shifts, (i, j), missing, margin):
                    return False
            if is_parted:
                return True
        return False

    def _correct(
        self, lower: Array, upper: Array, shifts: Array, pair: tuple[int, int], missing: Array, margin: float
    ) -> bool:
        """Move both boxes of a pair apart along the axis that needs less and has room, Eq. 6.2."""
        for axis in np.argsort(missing, kind="stable"):
            first, second = sorted(pair, key=lambda k: float(lower[k, axis] + upper[k, axis]))
            room = np.maximum(
                0.0,
                [
                    lower[first, axis] + shifts[first, axis] + margin,
                    self._size[axis] + margin - upper[second, axis] - shifts[second, axis],
                ],
            )  # towards the pallet's borders
            if room.sum() + TOUCH < missing[axis]:
                continue
            share = room[0] / room.sum() if room.sum() > 0.0 else 0.5
            shifts[first, axis] -= share * missing[axis]
            shifts[second, axis] += (1.0 - share) * missing[axis]
            return True
        return False
