"""Decides, box by box, where what arrives goes: online packing of several open pallets with a buffer.

Only the next boxes of the infeed are known. Each goes to the fullest of the open pallets that has a place for
it, or is set aside in the buffer where none has; where the buffer is full, too, the fullest pallet is closed.
While others have room that one is closed as soon as it is full enough and has no place for a box, or once
several boxes in a row had none on it: building goes on until an empty one stands there. A box that would not
even find a place on an empty pallet is rejected.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from pydantic import Field, NonNegativeFloat, NonNegativeInt, PositiveInt

from pack_core.config import Config
from pack_core.palletizing.cell import PALLET
from pack_core.palletizing.orders.item_list import Item
from pack_core.palletizing.orders.next_place import NextStep, StandingPallet
from pack_core.palletizing.orders.placed_box import PlacedBox
from pack_core.palletizing.orders.stack import Stack, empty_stack, with_box
from pack_planner.layout.online_packer import (
    FoundPlace,
    PackedItem,
    PackerConfig,
    Turns,
    best_place,
)


class OnlinePackerConfig(PackerConfig):
    """Parameters of the packer for boxes that come as they come: most are to lie as they come."""

    handling_price: NonNegativeFloat = Field(
        0.4, description="what standing a box up adds to the cost of a place, in the place rule's unit"
    )


class OnlineConfig(Config):
    """Parameters of the online planner."""

    packer: OnlinePackerConfig = OnlinePackerConfig()
    pallets: PositiveInt = Field(2, description="that are open at a time")
    buffer: NonNegativeInt = Field(2, description="boxes that can be set aside")
    preview: PositiveInt = Field(1, description="boxes of the infeed that are known and can be taken")
    enough: float = Field(
        0.58, ge=0, le=1, description="share of the room up to the highest top from which on the fullest of "
        "several pallets is closed at the first box that has no place on it"
    )  # fmt: skip
    misses: PositiveInt = Field(
        6, description="boxes in a row without a place on the fullest of several pallets that close it before"
    )


@dataclass(frozen=True)
class OpenPallet:
    """A pallet that is being built.

    Attributes:
        stack: what stands on it, as the search for places needs it.
        boxes: its boxes in the sequence of placing.
        place: where it stands.
        missed: boxes that were placed on other pallets since the last one was placed on it.
    """

    stack: Stack
    boxes: tuple[PlacedBox, ...] = ()
    place: str = PALLET
    missed: int = 0

    @property
    def volume(self) -> float:
        """Of all its boxes [m^3]."""
        return sum(float(np.prod(box.size)) for box in self.boxes)

    def with_box(self, box: PlacedBox) -> OpenPallet:
        """The pallet with one box more."""
        return replace(self, stack=with_box(self.stack, box), boxes=(*self.boxes, box), missed=0)

    @staticmethod
    def of(pallet: StandingPallet) -> OpenPallet:
        """A pallet of which is told what stands on it."""
        stack = empty_stack()
        for box in pallet.boxes:
            stack = with_box(stack, box)
        return OpenPallet(stack, pallet.boxes, pallet.place, pallet.missed)


@dataclass(frozen=True)
class Floor:
    """What stands: the open pallets, and the boxes that were set aside."""

    pallets: tuple[OpenPallet, ...]
    buffered: tuple[Item, ...] = ()

    @staticmethod
    def empty(pallets: int) -> Floor:
        """So many empty pallets and nothing set aside."""
        return Floor((OpenPallet(empty_stack()),) * pallets)


@dataclass(frozen=True)
class Decision:
    """What is done next, and why.

    Attributes:
        step: whether a box is placed, set aside or rejected, or a pallet is closed.
        reason: in words.
        item: the box that is placed, set aside or rejected.
        pallet: number of the open pallet on which it is placed, or which is closed.
        entry: the box at its place.
    """

    step: NextStep
    reason: str
    item: Item | None = None
    pallet: int | None = None
    entry: PackedItem | None = None


IsAllowed = Callable[[OpenPallet, PackedItem], bool]
"""Whether a place can be used for reasons beyond the stack's own: reach, and the side the box comes from."""


class OnlinePlanner:
    """Decides where boxes go.

    Args:
        area: length and width of a pallet [m].
        turns: the turns that each item may be given, by its id.
        config: parameters.
        is_allowed: what else a place must fulfil.
    """

    def __init__(
        self, area: tuple[float, float], turns: Turns, config: OnlineConfig,
        is_allowed: IsAllowed = lambda pallet, entry: True,
    ) -> None:  # fmt: skip
        self._area, self._turns, self._config, self._is_allowed = area, turns, config, is_allowed

    def decide(self, floor: Floor, infeed: Sequence[Item]) -> Decision:
        """What is done next with the boxes set aside and those that arrive, the first `preview` of them."""
        known = infeed[: self._config.preview]
        # A box set aside goes first: its place on the table is worth more than a better one for another box.
        for group in (floor.buffered, known):
            if found := self._best(floor, group):
                number, place = found
                fullest = fullest_first(floor)[0]
                if number != fullest and (reason := self._why_closed(floor.pallets[fullest])):
                    return Decision(NextStep.CLOSE, reason, pallet=fullest)
                reason = f"the cheapest place by the rule {self._config.packer.rule}"
                return Decision(NextStep.PLACE, reason, place.entry.item, number, place.entry)
        for item in known:
            if self._best(Floor.empty(1), (item,)) is None:
                return Decision(NextStep.REJECT, "it finds no place even on an empty pallet", item)
        if known and len(floor.buffered) < self._config.buffer:
            return Decision(NextStep.SET_ASIDE, "no open pallet has a place for it", known[0])
        reason = "no open pallet has a place for any known box, and the buffer is full"
        return Decision(NextStep.CLOSE, reason, pallet=fullest_first(floor)[0])

    def _why_closed(self, pallet: OpenPallet) -> str:
        """Why a pallet without a place for a box is closed, though another has one; empty where it is not."""
        missed, room = pallet.missed + 1, float(np.prod(self._area)) * self._config.packer.highest
        if pallet.volume >= self._config.enough * room:
            return f"it is {pallet.volume / room:.0%} full and has no place for a box"
        return f"{missed} boxes in a row have no place on it" if missed >= self._config.misses else ""

    def _best(self, floor: Floor, items: Sequence[Item]) -> tuple[int, FoundPlace] | None:
        """The cheapest place of any item on the fullest pallet that has one, and that one's number."""
        for number in fullest_first(floor):
            pallet = floor.pallets[number]
            places = (
                best_place(
                    item, self._turns[item.id], pallet.stack, self._area, self._config.packer,
                    partial(self._is_allowed, pallet),
                )
                for item in items
            )  # fmt: skip
            found = [place for place in places if place is not None]
            if found:
                return number, min(found, key=lambda place: place.cost)
        return None


def fullest_first(floor: Floor) -> list[int]:
    """The numbers of the open pallets, that with the largest volume of boxes first."""
    return sorted(range(len(floor.pallets)), key=lambda number: -floor.pallets[number].volume)


def carried_out(floor: Floor, decision: Decision) -> Floor:
    """What stands once a decision was carried out; a closed pallet is replaced by an empty one."""
    pallets = list(floor.pallets)
    if decision.step is NextStep.SET_ASIDE and decision.item is not None:
        return replace(floor, buffered=(*floor.buffered, decision.item))
    if decision.pallet is None:
        return floor
    if decision.entry is None:
        pallets[decision.pallet] = OpenPallet(empty_stack())
        return replace(floor, pallets=tuple(pallets))
    pallets = [replace(pallet, missed=pallet.missed + 1) for pallet in pallets]
    pallets[decision.pallet] = pallets[decision.pallet].with_box(decision.entry.placed)
    buffered = tuple(item for item in floor.buffered if item is not decision.item)
    return Floor(tuple(pallets), buffered)
