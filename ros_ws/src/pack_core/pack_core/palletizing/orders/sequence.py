"""The sequence in which boxes are put on the pallet, so that the arm never has to reach into a deep well."""

from __future__ import annotations

from collections.abc import Sequence

from pack_core.palletizing.orders.placed_box import PlacedBox


def resequence(boxes: Sequence[PlacedBox], rise: float) -> tuple[PlacedBox, ...]:
    """Sort boxes so that the stack grows evenly; otherwise keep the given sequence.

    A box is ready when no box that is still to be placed belongs under it. The next box is the first ready
    one in the given sequence whose top is at most `rise` [m] over the lowest base of all ready boxes. Where
    there is none, it is the ready box with the lowest top, so that boxes placed later have low neighbours.
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
