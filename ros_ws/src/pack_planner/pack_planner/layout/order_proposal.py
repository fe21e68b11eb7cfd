"""Proposes orders for a list of items: packings of several sequences and areas, the fullest first."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import combinations

import numpy as np
from pydantic import Field, NonNegativeInt, PositiveInt

from pack_core.config import Config
from pack_core.palletizing.cell import PalletizingCell
from pack_core.palletizing.orders.item_list import Item
from pack_core.palletizing.orders.order import Order
from pack_planner.layout.online_packer import PackedItem, PackerConfig, Packing, pack_in_sequence

Rule = Callable[[Item], tuple[float, ...]]


class ProposalConfig(Config):
    """How hard packings are searched for."""

    packer: PackerConfig = PackerConfig()
    areas: PositiveInt = Field(12, description="sizes of the covered area that are tried")
    shuffles: NonNegativeInt = Field(4, description="random sequences that are tried")
    seed: NonNegativeInt = Field(0, description="of these")


SEQUENCES: dict[str, Rule] = {
    "largest base first": lambda item: (-_edges(item)[0] * _edges(item)[1], -_edges(item)[2]),
    "largest volume first": lambda item: (-float(np.prod(item.size)),),
    "thickest first": lambda item: (-_edges(item)[2], -_edges(item)[0]),
    "longest first": lambda item: (-_edges(item)[0], -_edges(item)[1]),
}
"""Sequences in which items are packed, besides the given one and random ones."""


def packings_of(
    items: Sequence[Item], pallet: tuple[float, float], config: ProposalConfig
) -> Iterator[Packing]:
    """Packings of all items on a pallet of some length and width [m], as they are found.

    The given sequence comes first, as boxes that arrive one by one allow no other.
    """
    for area in _areas(items, pallet, config):
        for sequence in _sequences(items, config):
            for by_height in (True, False):
                packing = pack_in_sequence(sequence, area, config.packer, by_height=by_height)
                if not packing.left:
                    yield packing


def order_of(packing: Packing, name: str, cell: PalletizingCell, *, article: str = "") -> Order:
    """The order of a packing, its stack in the middle of the pallet's deck."""
    pallet = cell.pallet
    free = np.array(pallet.size) - packing.extents[:2]
    lower = np.min([entry.placed.lower for entry in packing.packed], axis=0)[:2]
    shift = np.array([*np.round(0.5 * free - lower, 3), 0.0])
    return Order.model_validate({
        "order_id": name,
        "pallet": {"length": pallet.size[0], "width": pallet.size[1], "deck_height": pallet.deck_height},
        "placement_planner": "extreme points, least surface area",
        "boxes": [_box(entry, shift) for entry in packing.packed],
        "note": article,
    })  # fmt: skip


def _box(entry: PackedItem, shift: np.ndarray) -> dict[str, object]:
    position = np.round(entry.placed.lower + shift, 4).tolist()
    return {
        "id": entry.item.id, "article": entry.item.article, "weight": entry.item.weight,
        "dims": sorted(entry.item.size, reverse=True), "orient_id": entry.turn.orient_id,
        "bundling_axis": entry.turn.bundling_axis, "position": position,
        "this_side_up": entry.item.this_side_up,
    }  # fmt: skip


def _sequences(items: Sequence[Item], config: ProposalConfig) -> Iterator[list[Item]]:
    yield list(items)
    for rule in SEQUENCES.values():
        yield sorted(items, key=rule)
    rng = np.random.default_rng(config.seed)
    for _ in range(config.shuffles):
        yield [items[k] for k in rng.permutation(len(items))]


def _areas(
    items: Sequence[Item], pallet: tuple[float, float], config: ProposalConfig
) -> list[tuple[float, float]]:
    """Sizes of the area that is covered: the whole pallet, and smaller ones that edges of boxes add up to.

    An area is worth trying if the stack on it is neither higher than allowed nor lower than a box.
    """
    gap, volume = config.packer.gap, sum(float(np.prod(item.size)) for item in items)
    edges = sorted({edge for item in items for edge in item.size})
    sums = {
        round(sum(some) + gap * (len(some) - 1), 4)
        for n in (1, 2, 3)
        for some in combinations([edge for edge in edges for _ in range(n)], n)
    }
    thinnest = max(min(item.size) for item in items)
    tried = [
        (length, width)
        for length in sums
        for width in sums
        if length <= pallet[0] and width <= pallet[1]
        and thinnest <= volume / (length * width) <= 0.9 * config.packer.highest
    ]  # fmt: skip
    # Compact stacks first: the least surface of a box with this base and the items' volume.
    tried.sort(key=lambda area: area[0] * area[1] + (area[0] + area[1]) * volume / (area[0] * area[1]))
    step = max(len(tried) // config.areas, 1)
    return [*tried[: step * config.areas : step], pallet]


def _edges(item: Item) -> tuple[float, float, float]:
    a, b, c = sorted(item.size, reverse=True)
    return a, b, c
