"""A layout: its layers, the sequence in which it is built, and the layout service's answer for each box."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum
from itertools import groupby

import numpy as np

from pack_core.palletizing.orders.order import Order
from pack_core.palletizing.orders.placed_box import PlacedBox
from pack_core.rotations import Array

LAYER_STEP = 0.001
"""Heights of bases are rounded to multiples of this; equal ones are in one layer [m]."""


class LayoutStatus(IntEnum):
    """Outcome of planning a layout; the values are those of pack_interfaces/PlanLayout."""

    SUCCESS = 1
    INFEASIBLE = 2
    UNSTABLE = 3
    INVALID_INPUT = 4


@dataclass(frozen=True)
class Insertion:
    """The way on which a box comes to its place (Sec. 6.3 of the thesis).

    Attributes:
        direction: name of the side that the box comes from; Center: straight down.
        outward: horizontal unit vector `(3,)` in P from the place towards where the box comes from; zero
            for Center.
        corridor: length [m] along `outward` that is free for the box at its height; zero for Center.
    """

    direction: str
    outward: Array
    corridor: float

    def start(self, centre: Array) -> Array:
        """Where the corridor begins `(3,)`: c + L d, Eq. 6.6, for the placed box's centre c."""
        return centre + self.corridor * self.outward

    def offset(self, standoff: float, lift: float) -> Array:
        """From the place to a point above and beside it `(3,)` [m], out by at most the corridor."""
        return np.asarray(min(standoff, self.corridor) * self.outward + np.array([0.0, 0.0, lift]))


@dataclass(frozen=True)
class PlannedBox:
    """A box at its place in the layout with gaps, and its insertion."""

    placed: PlacedBox
    insertion: Insertion


@dataclass(frozen=True)
class LayoutPlan:
    """A layout that can be built.

    Attributes:
        status: whether a layout was found.
        reason: why none was found, in words; empty after success.
        boxes: the boxes in the sequence in which they are to be placed; empty without success.
        gap: the wanted free distance between neighbours [m].
        virtual_margin: how far boxes may stand over the pallet's edge to reach the gap [m].
    """

    status: LayoutStatus
    reason: str
    boxes: tuple[PlannedBox, ...]
    gap: float
    virtual_margin: float


def laid_out(order: Order, plan: LayoutPlan) -> Order:
    """An order with its boxes at their places in a layout, in the sequence of placing.

    All else that the order says of a box stays. `source` has the gap, how far boxes stand over the edge, and
    the side that each box comes from.
    """
    boxes = [
        order.box(item.placed.id).model_copy(
            update={"position": tuple(np.round(item.placed.lower, 6).tolist()), "seq": number}
        )
        for number, item in enumerate(plan.boxes, start=1)
    ]
    insertions = {
        item.placed.id: {"from": item.insertion.direction, "corridor": round(item.insertion.corridor, 6)}
        for item in plan.boxes
    }
    layout = {"gap": plan.gap, "virtual_margin": plan.virtual_margin, "insertions": insertions}
    return order.model_copy(update={"boxes": tuple(boxes), "source": {**order.source, "layout": layout}})


def layers_of(boxes: Sequence[PlacedBox]) -> list[tuple[PlacedBox, ...]]:
    """The layers from the deck upwards."""
    by_height = sorted(boxes, key=_base_step)
    return [tuple(layer) for _, layer in groupby(by_height, key=_base_step)]


def _base_step(item: PlacedBox) -> int:
    return round(float(item.lower[2]) / LAYER_STEP)


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
