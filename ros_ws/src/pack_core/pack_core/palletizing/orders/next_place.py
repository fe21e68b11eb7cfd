"""The question where a box goes that has just come, and the answer: a place, or what is done instead."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from pack_core.palletizing.orders.item_list import Item
from pack_core.palletizing.orders.layout_plan import PlannedBox
from pack_core.palletizing.orders.placed_box import PlacedBox


class NextStep(StrEnum):
    """What is done next."""

    PLACE = "place"
    SET_ASIDE = "set aside"
    REJECT = "reject"
    CLOSE = "close"


@dataclass(frozen=True)
class StandingPallet:
    """A pallet that is being built.

    Attributes:
        place: name of its place.
        boxes: what stands on it, in the pallet's frame, in the sequence of placing.
        missed: boxes that were placed on other pallets since the last one was placed on it.
    """

    place: str
    boxes: tuple[PlacedBox, ...] = ()
    missed: int = 0


@dataclass(frozen=True)
class PlaceQuestion:
    """Where do boxes go?

    Attributes:
        number: of the question, which the answer repeats.
        pallets: those that are open.
        buffered: boxes that were set aside, in the sequence in which that was done.
        known: boxes that have come, first the one that can be picked.
        room: how many more boxes can be set aside.
    """

    number: int
    pallets: tuple[StandingPallet, ...]
    buffered: tuple[Item, ...]
    known: tuple[Item, ...]
    room: int


@dataclass(frozen=True)
class PlaceAnswer:
    """What is done next, and why.

    Attributes:
        number: of the question.
        step: whether a box is placed, set aside or rejected, or a pallet is closed.
        reason: in words.
        item: id of the box that is placed, set aside or rejected; empty where a pallet is closed.
        pallet: name of the place of the pallet on which it is placed, or which is closed; empty otherwise.
        plan: its place and the way in, in the pallet's frame; its extents there say how it is turned. None
            unless it is placed.
    """

    number: int
    step: NextStep
    reason: str
    item: str = ""
    pallet: str = ""
    plan: PlannedBox | None = None
