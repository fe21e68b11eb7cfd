"""Proposes orders for a list of items: packings of several sequences and areas, full and low ones first."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import combinations_with_replacement

import numpy as np
from pydantic import Field, NonNegativeFloat, NonNegativeInt, PositiveInt

from pack_core.config import Config
from pack_core.palletizing.cell import PalletizingCell
from pack_core.palletizing.orders.handling import TurnChoice, turns_of
from pack_core.palletizing.orders.item_list import Item
from pack_core.palletizing.orders.order import Order
from pack_core.palletizing.orders.order_check import misfits_of
from pack_planner.layout.online_packer import PackedItem, PackerConfig, Packing, Turns, pack_in_sequence

Rule = Callable[[Item], tuple[float, ...]]


class ProposalConfig(Config):
    """How hard packings are searched for."""

    packer: PackerConfig = PackerConfig()
    areas: PositiveInt = Field(12, description="sizes of the covered area that are tried")
    shuffles: NonNegativeInt = Field(4, description="random sequences that are tried")
    seed: NonNegativeInt = Field(0, description="of these")
    nearly: NonNegativeFloat = Field(
        0.05, lt=1.0, description="share of the box around a stack that may be empty so that it is lower"
    )
    may_sort: bool = Field(True, description="whether boxes may come in another sequence than the list's")


RULES = ("touching", "low_top", "least_surface")
"""Rules for places that are tried with every sequence."""
SEQUENCES: dict[str, Rule] = {
    "largest base first": lambda item: (-_edges(item)[0] * _edges(item)[1], -_edges(item)[2]),
    "largest volume first": lambda item: (-float(np.prod(item.size)),),
    "thickest first": lambda item: (-_edges(item)[2], -_edges(item)[0]),
    "longest first": lambda item: (-_edges(item)[0], -_edges(item)[1]),
}
"""Sequences in which items are packed, besides the given one and random ones."""


def possible_turns(items: Sequence[Item], cell: PalletizingCell) -> tuple[Turns, tuple[str, ...]]:
    """For each item the turns in which the cell's gripper can hold it, the cheapest first.

    Returns:
        The turns by the items' ids, none for an item that cannot be held, and why it cannot.
    """
    found: dict[str, list[TurnChoice]] = {}
    problems: list[str] = []
    for item in items:
        refusals: list[str] = []
        found[item.id] = []
        for turn in turns_of(item.size, this_side_up=item.this_side_up):
            why = misfits_of(_order([_box(item, turn, [0.0, 0.0, 0.0])], "one box", cell), cell)
            refusals += why
            if not why:
                found[item.id].append(turn)
        if not found[item.id]:
            problems += dict.fromkeys(refusals)
    return found, tuple(problems)


def packings_of(
    items: Sequence[Item], turns: Turns, cell: PalletizingCell, config: ProposalConfig
) -> Iterator[Packing]:
    """Packings on the cell's pallet, complete or not, as they are found.

    Boxes are packed with gaps. Where not all find a place so, as when they fill the deck from edge to edge,
    they are packed without, and it is left to the layout to part them over the pallet's edge.
    """
    is_complete = False
    for gap in (config.packer.gap, 0.0):
        packer = config.packer.model_copy(update={"gap": gap})
        for area in _areas(items, cell.pallet.size, config):
            for sequence in _sequences(items, config):
                for rule in RULES:
                    packing = pack_in_sequence(
                        sequence, turns, area, packer.model_copy(update={"rule": rule})
                    )
                    is_complete |= not packing.left
                    yield packing
        if is_complete:
            return


def ranked(packings: Sequence[Packing], nearly: float) -> list[Packing]:
    """Packings of some boxes, best first: of those nearly as full as the fullest the lowest, then the others.

    Most items come first: a full box around half of the items helps nobody. Of packings as low as each other
    the one comes first with fewer boxes stood up, which doubles a box's cycle.

    Args:
        packings: complete ones or not.
        nearly: how much less of the box around its stack a packing may fill than the fullest one.
    """
    fullest: dict[int, float] = {}
    for packing in packings:
        fullest[len(packing.left)] = max(packing.fill, fullest.get(len(packing.left), 0.0))

    def rank(packing: Packing) -> tuple[float, ...]:
        left, fill = len(packing.left), packing.fill
        if fill < fullest[left] - nearly:
            return left, 1, -fill
        return left, 0, round(float(packing.extents[2]), 3), packing.stood_up, -fill

    return sorted(packings, key=rank)


def order_of(packing: Packing, name: str, cell: PalletizingCell) -> Order:
    """The order of a packing, its stack in the middle of the pallet's deck."""
    free = np.array(cell.pallet.size) - packing.extents[:2]
    lower = np.min([entry.placed.lower for entry in packing.packed], axis=0)[:2]
    shift = np.array([*np.round(0.5 * free - lower, 3), 0.0])
    return _order([_placed(entry, shift) for entry in packing.packed], name, cell)


def _order(boxes: list[dict[str, object]], name: str, cell: PalletizingCell) -> Order:
    pallet = cell.pallet
    return Order.model_validate({
        "order_id": name,
        "pallet": {"length": pallet.size[0], "width": pallet.size[1], "deck_height": pallet.deck_height},
        "placement_planner": "extreme points, closed tipping rule",
        "boxes": boxes,
    })  # fmt: skip


def _placed(entry: PackedItem, shift: np.ndarray) -> dict[str, object]:
    return _box(entry.item, entry.turn, np.round(entry.placed.lower + shift, 4).tolist())


def _box(item: Item, turn: TurnChoice, position: list[float]) -> dict[str, object]:
    return {
        "id": item.id, "article": item.article, "dims": sorted(item.size, reverse=True),
        "weight": item.weight, "orient_id": turn.orient_id, "bundling_axis": turn.bundling_axis,
        "position": position, "this_side_up": item.this_side_up, "max_load": item.max_load,
        "max_pressure": item.max_pressure,
    }  # fmt: skip


def _sequences(items: Sequence[Item], config: ProposalConfig) -> Iterator[list[Item]]:
    yield list(items)
    if not config.may_sort:
        return
    for rule in SEQUENCES.values():
        yield sorted(items, key=rule)
    rng = np.random.default_rng(config.seed)
    for _ in range(config.shuffles):
        yield [items[k] for k in rng.permutation(len(items))]


def _areas(
    items: Sequence[Item], pallet: tuple[float, float], config: ProposalConfig
) -> list[tuple[float, float]]:
    """Sizes of the area that is covered: the whole pallet, and smaller ones that edges of boxes add up to.

    A smaller area is worth trying if the items, packed without any waste, would reach at least the height of
    the thickest of them on it, and not more than nine tenths of the allowed height.
    """
    gap, volume = config.packer.gap, sum(float(np.prod(item.size)) for item in items)
    edges = sorted({edge for item in items for edge in item.size})
    sums = {
        round(sum(some) + gap * (len(some) - 1), 4)
        for n in (1, 2, 3)
        for some in combinations_with_replacement(edges, n)
        if sum(some) <= max(pallet)
    }
    thinnest = max(min(item.size) for item in items)
    tried = [
        (length, width)
        for length in sums
        for width in sums
        if length <= pallet[0] and width <= pallet[1]
        and thinnest <= volume / (length * width) <= 0.9 * config.packer.highest
    ]  # fmt: skip
    # Compact stacks first: the least surface that a box of this base and the items' volume can have.
    tried.sort(key=lambda area: area[0] * area[1] + (area[0] + area[1]) * volume / (area[0] * area[1]))
    step = max(len(tried) // config.areas, 1)
    return [*tried[: step * config.areas : step], pallet]


def _edges(item: Item) -> tuple[float, float, float]:
    a, b, c = sorted(item.size, reverse=True)
    return a, b, c
