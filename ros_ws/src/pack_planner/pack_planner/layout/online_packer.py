"""Packs boxes onto a pallet one by one, each where it fits best among those that stand already."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Annotated

import numpy as np
from pydantic import AfterValidator, Field, NonNegativeFloat, PositiveFloat

from pack_core.config import Config
from pack_core.palletizing.orders.handling import PRICE, Handling, TurnChoice, turns_of
from pack_core.palletizing.orders.item_list import Item, placed_item
from pack_core.palletizing.orders.placed_box import PlacedBox
from pack_core.palletizing.orders.stack import Stack, empty_stack, with_box
from pack_core.palletizing.orders.support import SupportConfig
from pack_core.palletizing.orders.tipping import TippingConfig
from pack_core.rotations import Array
from pack_planner.layout.place_search import (
    Needs,
    PlaceCosts,
    Room,
    costs_of,
    first_standing,
    places_of,
)

PLACE_RULES = {
    "touching": PlaceCosts(untouched=1.0, top=1.0, near=1e-3, dead=60.0),
    "low_top": PlaceCosts(top=1.0, surface=1e-3, near=1e-5),
    "least_surface": PlaceCosts(surface=1.0, top=1e-3, near=1e-5),
    "bottom_left": PlaceCosts(base=1.0, near=1e-3),
}
"""What the places of a box are ranked by: most touching area and low top, but little room over a box that
bears nothing; the lowest top; the least surface of the block around the stack; or the lowest base."""


def _known_rule(name: str) -> str:
    if name not in PLACE_RULES:
        raise ValueError(f"one of {', '.join(PLACE_RULES)}")
    return name


Turns = Mapping[str, Sequence[TurnChoice]]


class PackerConfig(Config):
    """Parameters of the packer."""

    gap: NonNegativeFloat = Field(0.002, le=0.05, description="free distance between neighbours [m]")
    highest: PositiveFloat = Field(1.0, description="stack over the deck, at most [m]")
    handling_price: NonNegativeFloat = Field(
        0.02, description="what standing a box up adds to the cost of a place, in the place rule's unit"
    )
    rule: Annotated[str, AfterValidator(_known_rule)] = Field(
        "touching", description="what places are ranked by: " + ", ".join(PLACE_RULES)
    )
    support: SupportConfig = SupportConfig()
    tipping: TippingConfig = TippingConfig()


@dataclass(frozen=True)
class PackedItem:
    """An item at its place, and the turn that brings it there."""

    item: Item
    turn: TurnChoice
    placed: PlacedBox


@dataclass(frozen=True)
class Packing:
    """The outcome of packing a list of items.

    Attributes:
        packed: the items that found a place, in the sequence in which they were placed.
        left: those that did not.
    """

    packed: tuple[PackedItem, ...]
    left: tuple[Item, ...]

    @cached_property
    def fill(self) -> float:
        """Share of the box around the stack, all its layers, that the boxes take up; 0 without boxes."""
        if not self.packed:
            return 0.0
        volume = sum(float(np.prod(entry.placed.size)) for entry in self.packed)
        return volume / float(np.prod(self.extents))

    @property
    def stood_up(self) -> int:
        """Number of boxes that are stood up on the table on their way."""
        return sum(entry.turn.handling is Handling.TABLE for entry in self.packed)

    @property
    def extents(self) -> Array:
        """Edges of the box around the stack `(3,)` [m], from the deck upwards."""
        upper = np.max([entry.placed.upper for entry in self.packed], axis=0)
        lower = np.min([entry.placed.lower for entry in self.packed], axis=0)
        return np.array([*(upper - lower)[:2], upper[2]])


def pack_in_sequence(
    items: Sequence[Item], turns: Turns, area: tuple[float, float], config: PackerConfig
) -> Packing:
    """Pack items in the given sequence; where one stands does not depend on those after it.

    Args:
        items: the items in the sequence of their arrival.
        turns: the turns that each item may be given, by its id.
        area: length and width of the area that may be covered [m].
        config: parameters.
    """
    stack = empty_stack()
    packed: list[PackedItem] = []
    left: list[Item] = []
    for item in items:
        best = best_place(item, turns[item.id], stack, area, config)
        if best is None:
            left.append(item)
            continue
        packed.append(best.entry)
        stack = with_box(stack, best.entry.placed)
    return Packing(tuple(packed), tuple(left))


@dataclass(frozen=True)
class FoundPlace:
    """The best place of an item, and what it costs by the rule that ranks places."""

    entry: PackedItem
    cost: float


def best_place(
    item: Item, turns: Sequence[TurnChoice], stack: Stack, area: tuple[float, float], config: PackerConfig,
    is_allowed: Callable[[PackedItem], bool] = lambda entry: True,
) -> FoundPlace | None:  # fmt: skip
    """The best place at which an item stands, tips nothing and overloads nothing; None where there is none.

    Args:
        item: what is to be placed.
        turns: the turns that it may be given.
        stack: what stands already.
        area: length and width of the area that may be covered [m].
        config: parameters.
        is_allowed: what else a place must fulfil; it is asked last, and of the cheapest places first.
    """
    room = Room(*area, config.highest, config.gap)
    needs = Needs(config.support.min_share, config.support.min_margin, config.tipping.push)
    costs = PLACE_RULES[config.rule]
    bears = item.max_load != 0.0
    places, sizes, prices, choices = [], [], [], []
    for number, turn in enumerate(turns):
        size = np.array(turn.extents)
        found = places_of(stack, size, room)
        places.append(found)
        sizes.append(np.broadcast_to(size, found.shape))
        price = config.handling_price * PRICE[turn.handling]
        prices.append(costs_of(stack, size, bears, found, room, costs) + price)
        choices.append(np.full(len(found), number))
    every_place, every_size = np.concatenate(places), np.concatenate(sizes)
    every_price, every_choice = np.concatenate(prices), np.concatenate(choices)
    order = np.argsort(every_price, kind="stable")
    position = -1
    while True:
        position = first_standing(stack, every_size, every_place, order, position + 1, item.weight, needs)
        if position == len(order):
            return None
        m = order[position]
        entry = PackedItem(item, turns[every_choice[m]], placed_item(item, every_place[m], every_size[m]))
        if is_allowed(entry):
            return FoundPlace(entry, float(every_price[m]))


@cache
def warm_up() -> None:
    """Have numba compile the search for places before the first box; loads it where that was done before."""
    item = Item(id="a", article="a", size=(0.4, 0.3, 0.2), weight=1.0, this_side_up=True)
    turns = {name: turns_of(item.size, this_side_up=True) for name in ("a", "b")}
    other = item.model_copy(update={"id": "b"})
    pack_in_sequence((item, other), turns, (0.4, 0.3), PackerConfig())
