"""Which of several packings of the same boxes is proposed first."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

from pack_core.palletizing.cell import palletizing_cell
from pack_core.palletizing.orders.handling import TurnChoice, turns_of
from pack_core.palletizing.orders.item_list import Item
from pack_core.palletizing.orders.placed_box import PlacedBox
from pack_planner.layout.online_packer import PackedItem, Packing
from pack_planner.layout.order_proposal import ProposalConfig, packings_of, possible_turns, ranked

NEARLY = 0.05
ITEM = Item(id="a", article="a", size=(0.3, 0.2, 0.1), weight=2.0, this_side_up=False)


def packing(height: float, fill: float = 1.0, left: int = 0) -> Packing:
    """One box of ITEM's size with `height` upwards; a second one far enough off for this `fill`."""
    turn = next(turn for turn in turns(ITEM) if turn.extents[2] == height)
    size = np.array(turn.extents)
    shift = np.array([2.0 * size[0] / fill - size[0], 0.0, 0.0])
    packed = (PackedItem(ITEM, turn, PlacedBox(name, p, size, 2.0)) for name, p in places(shift))
    return Packing(tuple(packed), (ITEM,) * left)


def turns(item: Item) -> tuple[TurnChoice, ...]:
    return turns_of(item.size, this_side_up=False)


def places(shift: np.ndarray) -> Iterator[tuple[str, np.ndarray]]:
    yield "a", np.zeros(3)
    yield "b", shift


def test_of_packings_nearly_as_full_the_lowest_comes_first() -> None:
    tower, flat = packing(0.3), packing(0.1, fill=0.96)
    assert ranked([tower, flat], NEARLY) == [flat, tower]


def test_a_packing_that_is_much_less_full_comes_last_however_low_it_is() -> None:
    tower, flat = packing(0.3), packing(0.1, fill=0.90)
    assert ranked([flat, tower], NEARLY) == [tower, flat]


def test_a_packing_with_more_of_the_items_comes_first() -> None:
    whole, half = packing(0.3, fill=0.7), packing(0.1, left=1)
    assert ranked([half, whole], NEARLY) == [whole, half]


def test_the_height_counts_before_how_many_are_stood_up_and_that_before_the_fill() -> None:
    lying, stood = packing(0.1, fill=0.97), packing(0.1)
    assert [lying.stood_up, packing(0.3).stood_up] == [0, 2]
    assert ranked([lying, stood], NEARLY) == [stood, lying]  # as low, none stood up, fuller


@pytest.mark.parametrize("size", [(0.4, 0.3, 0.2), (0.5, 0.3, 0.2)])
def test_a_single_box_is_laid_on_its_largest_face(size: tuple[float, float, float]) -> None:
    item = ITEM.model_copy(update={"size": size})
    turns, _ = possible_turns([item], palletizing_cell())
    found = packings_of([item], turns, palletizing_cell(), ProposalConfig())
    best = ranked([packing for packing in found if packing.packed], NEARLY)[0]
    assert (best.extents[2], best.stood_up) == (pytest.approx(size[2]), 0)
