"""Lists of items become packings that can be built, and full ones."""

from __future__ import annotations

from itertools import combinations
from typing import Any

import numpy as np
import pytest

from pack_core.palletizing.cell import palletizing_cell
from pack_core.palletizing.orders.handling import Handling, turns_of
from pack_core.palletizing.orders.item_list import Item, load_items
from pack_core.palletizing.orders.layout_plan import LayoutStatus
from pack_core.palletizing.orders.load_bearing import overloaded_boxes
from pack_core.palletizing.orders.order_file import reasons_against
from pack_core.palletizing.orders.stack import empty_stack
from pack_core.palletizing.orders.support import support_of
from pack_core.palletizing.orders.tipping import tipping_boxes
from pack_core.paths import config_path
from pack_planner.layout.layout_planner import LayoutConfig, LayoutPlanner
from pack_planner.layout.online_packer import PLACE_RULES, PackerConfig, Packing, best_place, pack_in_sequence
from pack_planner.layout.order_proposal import ProposalConfig, order_of, packings_of, possible_turns

CELL, CONFIG = palletizing_cell(), PackerConfig()
AREA = CELL.pallet.size


def items(number: int) -> tuple[Item, ...]:
    return load_items(config_path("orders", f"order_{number:02d}.json"))


def item(name: str, *size: float, weight: float = 5.0, this_side_up: bool = False) -> Item:
    return Item(id=name, article=name, size=size, weight=weight, this_side_up=this_side_up)


def packed(some: tuple[Item, ...], **changes: Any) -> Packing:
    turns, _ = possible_turns(some, CELL)
    return pack_in_sequence(some, turns, AREA, PackerConfig(**changes))


@pytest.mark.parametrize("rule", PLACE_RULES)
def test_boxes_stand_apart_on_the_pallet_carried_and_none_is_put_under_another(rule: str) -> None:
    packing = packed(items(11), rule=rule)
    stack = [entry.placed for entry in packing.packed]
    assert len(stack) + len(packing.left) == len(items(11))
    for one, other in combinations(stack, 2):
        assert not one.overlaps(other)
        if one.is_beside(other):
            assert one.clearance(other)[:2].max() > CONFIG.gap - 1e-5
        assert not one.is_over(other)  # one was placed earlier
    for k, entry in enumerate(stack):
        assert support_of(entry, stack[:k]).problem(CONFIG.support) is None
        assert np.all(entry.lower > -1e-6)
        assert np.all(entry.upper < np.array([*AREA, CONFIG.highest]) + 1e-6)
    assert tipping_boxes(stack, CONFIG.tipping) == {}


def test_where_a_box_stands_does_not_depend_on_those_that_come_after_it() -> None:
    some = items(8)
    few, all_of_them = packed(some[:5]), packed(some)
    for one, other in zip(few.packed, all_of_them.packed, strict=False):
        np.testing.assert_array_equal(one.placed.lower, other.placed.lower)


@pytest.mark.parametrize("number", [1, 3, 6, 9])
def test_proposals_are_full_and_pass_every_check_of_the_cell(number: int) -> None:
    some = items(number)
    turns, _ = possible_turns(some, CELL)
    found = [entry for entry in packings_of(some, turns, CELL, ProposalConfig()) if not entry.left]
    best = max(found, key=lambda packing: packing.fill)
    assert best.fill >= 0.65
    order = order_of(best, "proposal", CELL)
    assert reasons_against(order, LayoutConfig().support, CELL) == []
    assert LayoutPlanner(LayoutConfig()).plan(order).status is LayoutStatus.SUCCESS


def test_the_share_of_volume_is_that_of_the_box_around_the_stack() -> None:
    two = (item("a", 0.4, 0.3, 0.2), item("b", 0.4, 0.3, 0.2))
    packing = packed(two)
    lower, upper = (
        np.array([getattr(entry.placed, end) for entry in packing.packed]) for end in ("lower", "upper")
    )
    around = np.prod(upper.max(axis=0) - lower.min(axis=0))
    assert packing.fill == pytest.approx(2 * 0.4 * 0.3 * 0.2 / around)


def test_what_must_stay_upright_stays_upright() -> None:
    turns = turns_of((0.3, 0.2, 0.4), this_side_up=True)
    assert {turn.extents[2] for turn in turns} == {0.4}
    assert len(turns_of((0.3, 0.2, 0.4), this_side_up=False)) == 6
    assert turns_of((0.4, 0.3, 0.2), this_side_up=False)[0].handling is Handling.NONE


def test_an_item_that_no_grip_holds_is_refused_by_name() -> None:
    turns, refusals = possible_turns(
        (item("anvil", 0.4, 0.4, 0.4, weight=40.0), item("b", 0.4, 0.3, 0.2)), CELL
    )
    assert not turns["anvil"]
    assert turns["b"]
    assert all(reason.startswith("box 'anvil': 40 kg") for reason in refusals)


def test_what_finds_no_place_is_left_for_another_pallet() -> None:
    many = tuple(item(f"b{k}", 0.6, 0.4, 0.3) for k in range(15))
    packing = packed(many)
    assert len(packing.packed) + len(packing.left) == 15
    assert packing.left


def test_boxes_that_fill_the_deck_from_edge_to_edge_are_packed_without_gaps() -> None:
    many = tuple(item(f"b{k}", 0.6, 0.4, 0.3, this_side_up=True) for k in range(12))
    turns, _ = possible_turns(many, CELL)
    packings = packings_of(many, turns, CELL, ProposalConfig(areas=1, shuffles=0))
    found = [entry for entry in packings if not entry.left]
    assert found
    assert found[-1].fill == pytest.approx(1.0)


@pytest.mark.parametrize("limit", [{"max_load": 0.0}, {"max_load": 12.0}, {"max_pressure": 0.7}])
def test_nothing_carries_more_than_it_may(limit: dict[str, float]) -> None:
    some = tuple(one.model_copy(update=limit) for one in items(11))
    packing = packed(some)
    assert packing.packed
    assert overloaded_boxes([entry.placed for entry in packing.packed]) == {}
    assert len(packing.packed) <= len(packed(items(11)).packed)


def test_of_two_places_the_one_that_touches_more_is_taken() -> None:
    first, second = item("a", 0.4, 0.4, 0.2), item("b", 0.4, 0.4, 0.2)
    stack = [entry.placed for entry in packed((first, second)).packed]
    assert stack[0].clearance(stack[1])[:2].max() == pytest.approx(CONFIG.gap)


def test_a_place_that_is_not_allowed_is_passed_over_for_the_next_best() -> None:
    one = item("a", 0.4, 0.3, 0.2)
    turns, _ = possible_turns((one,), CELL)
    best = best_place(one, turns["a"], empty_stack(), AREA, CONFIG)
    assert best is not None
    other = best_place(
        one, turns["a"], empty_stack(), AREA, CONFIG,
        lambda entry: not np.array_equal(entry.placed.lower, best.entry.placed.lower),
    )  # fmt: skip
    assert other is not None
    assert other.cost >= best.cost
    assert best_place(one, turns["a"], empty_stack(), AREA, CONFIG, lambda entry: False) is None


def test_a_box_on_which_nothing_may_stand_goes_up() -> None:
    boxes = tuple(item(name, 0.4, 0.3, 0.2, this_side_up=True) for name in ("a", "b"))
    fragile = item("c", 0.4, 0.3, 0.1, this_side_up=True).model_copy(update={"max_load": 0.0})
    *_, last = packed((*boxes, fragile)).packed
    assert last.placed.lower[2] == pytest.approx(0.2)
    *_, last = packed((*boxes, fragile.model_copy(update={"max_load": None}))).packed
    assert last.placed.lower[2] == 0.0
