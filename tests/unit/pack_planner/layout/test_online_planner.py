"""Where what arrives goes, decided box by box."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest

from pack_core.palletizing.cell import palletizing_cell
from pack_core.palletizing.orders.item_list import Item
from pack_core.palletizing.orders.load_bearing import overloaded_boxes
from pack_core.palletizing.orders.next_place import NextStep
from pack_core.palletizing.orders.placed_box import PlacedBox
from pack_core.palletizing.orders.tipping import TippingConfig, tipping_boxes
from pack_planner.layout.insertion_direction import InsertionConfig
from pack_planner.layout.online_planner import (
    Decision,
    Floor,
    OnlineConfig,
    OnlinePackerConfig,
    OnlinePlanner,
    carried_out,
)
from pack_planner.layout.order_proposal import possible_turns
from pack_planner.layout.place_reach import PlaceReach

CELL = palletizing_cell()
AREA = CELL.pallet.size


def item(name: str, size: tuple[float, float, float] = (0.4, 0.3, 0.2), **limits: float) -> Item:
    return Item(id=name, article=name, size=size, weight=6.0, this_side_up=True, **limits)


def planner(items: Sequence[Item], **changes: Any) -> OnlinePlanner:
    turns, _ = possible_turns(items, CELL)
    return OnlinePlanner(AREA, turns, OnlineConfig(**changes))


def run(items: Sequence[Item], **changes: Any) -> tuple[Floor, list[Decision]]:
    """Decide until the infeed is empty; what stands then, and all decisions."""
    config = OnlineConfig(**changes)
    decide, floor, infeed, made = (
        planner(items, **changes).decide,
        Floor.empty(config.pallets),
        list(items),
        [],
    )
    while infeed:
        decision = decide(floor, infeed)
        made.append(decision)
        floor = carried_out(floor, decision)
        infeed = [one for one in infeed if one is not decision.item]
    return floor, made


def test_boxes_go_where_they_stand_tip_nothing_and_overload_nothing() -> None:
    rng = np.random.default_rng(1000)
    sizes = rng.choice([0.2, 0.25, 0.3, 0.35, 0.4], (40, 3))
    items = [item(f"b{k}", tuple(size.tolist()), max_pressure=1.5) for k, size in enumerate(sizes)]
    floor, made = run(items)
    assert sum(decision.step is NextStep.PLACE for decision in made) >= 30
    for pallet in floor.pallets:
        boxes = pallet.boxes
        assert tipping_boxes(boxes, TippingConfig()) == {}
        assert overloaded_boxes(boxes) == {}


def test_what_fits_nowhere_is_set_aside_and_then_the_fullest_pallet_is_closed() -> None:
    low = OnlinePackerConfig(highest=0.2)
    # Four of these cover more than half of a deck each, so that no fifth finds a place on two pallets.
    large = [item(f"large{k}", (0.7, 0.7, 0.15)) for k in range(4)]
    _, made = run(large, packer=low, pallets=2, buffer=1)
    steps = [decision.step for decision in made]
    assert steps[:4] == [NextStep.PLACE, NextStep.PLACE, NextStep.SET_ASIDE, NextStep.CLOSE]
    # The box that was set aside comes first on the new pallet.
    assert made[4].item is large[2]


def test_the_fuller_of_two_pallets_is_closed() -> None:
    low = OnlinePackerConfig(highest=0.2)
    items = [item("a", (0.7, 0.7, 0.1)), item("b", (0.7, 0.7, 0.15)), item("c", (0.7, 0.7, 0.15))]
    floor, made = run(items, packer=low, pallets=2, buffer=0)
    closing = next(decision for decision in made if decision.step is NextStep.CLOSE)
    placed = [decision for decision in made if decision.step is NextStep.PLACE]
    assert closing.pallet == placed[1].pallet
    assert sum(len(pallet.boxes) for pallet in floor.pallets) == 2


def test_a_box_goes_to_the_fullest_pallet_that_has_a_place() -> None:
    floor, _ = run(
        [item("large", (0.7, 0.7, 0.1)), item("a"), item("b")], packer=OnlinePackerConfig(highest=0.2)
    )
    assert [len(pallet.boxes) for pallet in floor.pallets] == [3, 0]


def test_the_fullest_pallet_is_closed_while_others_have_places_once_boxes_in_a_row_miss_it() -> None:
    low = OnlinePackerConfig(highest=0.2)
    large, two = item("large", (0.7, 0.7, 0.15)), [item(f"b{k}", (0.55, 0.55, 0.1)) for k in range(2)]
    _, made = run([large, *two], packer=low, misses=2, enough=1.0)
    steps = [(decision.step, decision.pallet) for decision in made]
    assert steps == [(NextStep.PLACE, 0), (NextStep.PLACE, 1), (NextStep.CLOSE, 0), (NextStep.PLACE, 1)]
    assert made[2].reason == "2 boxes in a row have no place on it"
    # A box that finds a place there begins the count anew.
    small = item("small", (0.3, 0.3, 0.1))
    _, made = run([large, two[0], small, two[1]], packer=low, misses=2, enough=1.0)
    assert [decision.pallet for decision in made] == [0, 1, 0, 1]


@pytest.mark.parametrize(("enough", "steps"), [
    (0.38, [NextStep.PLACE, NextStep.CLOSE, NextStep.PLACE]), (0.39, [NextStep.PLACE, NextStep.PLACE]),
])  # fmt: skip
def test_a_pallet_that_is_full_enough_is_closed_at_the_first_box_that_it_has_no_place_for(
    enough: float, steps: list[NextStep]
) -> None:
    # The first one takes up 0.7 x 0.7 x 0.15 of 1.2 x 0.8 x 0.2 m.
    boxes = [item("large", (0.7, 0.7, 0.15)), item("b", (0.55, 0.55, 0.1))]
    _, made = run(boxes, packer=OnlinePackerConfig(highest=0.2), enough=enough)
    assert [decision.step for decision in made] == steps


def test_with_a_preview_the_box_with_the_better_place_is_taken_first() -> None:
    tall, flat = item("tall", (0.3, 0.3, 0.5)), item("flat", (0.6, 0.4, 0.1))
    decision = planner([tall, flat], preview=2).decide(Floor.empty(1), [tall, flat])
    assert decision.item is flat
    assert planner([tall, flat]).decide(Floor.empty(1), [tall, flat]).item is tall


def test_a_place_out_of_reach_is_not_taken() -> None:
    one = item("a")
    turns, _ = possible_turns([one], CELL)
    free = OnlinePlanner(AREA, turns, OnlineConfig()).decide(Floor.empty(1), [one])
    assert free.entry is not None
    corner = free.entry.placed.lower
    elsewhere = OnlinePlanner(
        AREA, turns, OnlineConfig(), lambda pallet, entry: not np.array_equal(entry.placed.lower, corner)
    ).decide(Floor.empty(1), [one])
    assert elsewhere.entry is not None
    assert not np.array_equal(elsewhere.entry.placed.lower, corner)


def test_a_box_without_a_place_on_an_empty_pallet_is_rejected_and_closes_none() -> None:
    long, short = item("long", (1.3, 0.3, 0.2)), item("short")
    floor, made = run([long, short])
    assert [decision.step for decision in made] == [NextStep.REJECT, NextStep.PLACE]
    assert floor.buffered == ()


@pytest.mark.parametrize(("z", "is_reached"), [(0.0, True), (0.8, True), (3.5, False)])
def test_the_arm_reaches_the_whole_deck_up_to_a_metre_and_not_the_roof(z: float, is_reached: bool) -> None:
    reach = PlaceReach(CELL, InsertionConfig())
    for x in (0.0, 0.8):
        for y in (0.0, 0.5):
            box = PlacedBox("a", np.array([x, y, z]), np.array([0.4, 0.3, 0.2]), 5.0)
            assert reach.allows(box, []) == is_reached


@pytest.mark.parametrize(("top", "is_clear"), [(0.4, True), (0.59, False)])
def test_a_place_too_narrow_for_the_gripper_beside_a_higher_box_is_refused(
    top: float, is_clear: bool
) -> None:
    # The gripper's plate is 0.23 m over the face that it holds, and reaches 0.1 m to every side.
    reach = PlaceReach(CELL, InsertionConfig())
    high = PlacedBox("high", np.array([0.61, 0.53, 0.0]), np.array([0.59, 0.27, top]), 9.0)
    narrow = PlacedBox("narrow", np.array([0.69, 0.358, 0.18]), np.array([0.51, 0.17, 0.17]), 5.0)
    assert reach.allows(narrow, [high]) == is_clear


@pytest.mark.parametrize(("gap", "is_clear"), [(0.002, False), (0.05, True)])
def test_a_place_that_is_too_narrow_on_the_way_down_past_a_higher_box_is_refused(
    gap: float, is_clear: bool
) -> None:
    # The higher box stands on another one, over the level of the place, and is nearer on the way than there.
    reach = PlaceReach(CELL, InsertionConfig())
    box = PlacedBox("box", np.array([0.402, 0.162, 0.2]), np.array([0.37, 0.325, 0.195]), 5.0)
    low = PlacedBox("low", np.array([0.0, 0.0, 0.0]), np.array([0.35, 0.332, 0.5]), 9.0)
    high = PlacedBox("high", np.array([0.002 - gap + 0.05, 0.0, 0.5]), np.array([0.35, 0.332, 0.27]), 9.0)
    beside = PlacedBox("beside", np.array([0.782, 0.0, 0.0]), np.array([0.13, 0.49, 0.47]), 9.0)
    assert reach.allows(box, [low, high, beside]) == is_clear
