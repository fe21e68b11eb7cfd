"""The sequence in which boxes are put on the pallet, so that the arm never has to reach into a deep well."""

from __future__ import annotations

from collections.abc import Sequence

from pack_core.palletizing.orders.placed_box import PlacedBox


def resequence(boxes: Sequence[PlacedBox], rise: float) -> tuple[PlacedBox, ...]:
    """Sort boxes by where they can be put, else as given.

    The next box is the first in the given sequence that has nothing left to come under it and whose top is at
    most `rise` [m] over the lowest base of those that could be next. Where no top is that low, it is the
    lowest one: the neighbours of what is put later stay as low as they can.
    """
    rest, sorted_boxes = list(boxes), []
    while rest:
        ready = [item for item in rest if not any(item.is_over(other) for other in rest)]
        ceiling = min(item.lower[2] for item in ready) + rise
        low = [item for item in ready if item.upper[2] <= ceiling]
        chosen = low[0] if low else min(ready, key=lambda item: float(item.upper[2]))
        rest.remove(chosen)
        sorted_boxes.append(chosen)
    return tuple(sorted_boxes)
