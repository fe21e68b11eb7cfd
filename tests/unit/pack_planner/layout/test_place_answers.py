"""Where a box goes that has just come, as the cell asks for it."""

import numpy as np
import pytest

from pack_core.palletizing.cell import PALLET, SECOND_PALLET, palletizing_cell
from pack_core.palletizing.orders.item_list import Item
from pack_core.palletizing.orders.next_place import NextStep, PlaceQuestion, StandingPallet
from pack_core.palletizing.orders.placed_box import PlacedBox
from pack_planner.layout.insertion_direction import InsertionConfig
from pack_planner.layout.online_planner import OnlineConfig
from pack_planner.layout.place_answers import PlaceAnswers

CELL = palletizing_cell("shift")
EMPTY = (StandingPallet(PALLET), StandingPallet(SECOND_PALLET))
COVERED = PlacedBox("all", np.zeros(3), np.array([1.2, 0.8, 0.95]), 30.0)
TALL = PlacedBox("tall", np.array([0.3, 0.2, 0.0]), np.array([0.6, 0.4, 0.95]), 30.0)


@pytest.fixture(scope="module")
def answers() -> PlaceAnswers:
    return PlaceAnswers(CELL, OnlineConfig(), InsertionConfig())


def item(name: str, size: tuple[float, float, float] = (0.4, 0.3, 0.2), weight: float = 5.0) -> Item:
    return Item(id=name, article=name, size=size, weight=weight, this_side_up=True)


def question(pallets=EMPTY, buffered=(), known=(), room: int = 2) -> PlaceQuestion:
    return PlaceQuestion(7, pallets, buffered, known, room)


def test_a_box_gets_a_place_on_an_open_pallet_and_a_way_in(answers) -> None:
    answer = answers.answer(question(known=(item("a"),)))
    assert (answer.number, answer.step, answer.item) == (7, NextStep.PLACE, "a")
    assert answer.pallet in CELL.pallets
    assert sorted(answer.plan.placed.size) == sorted(item("a").size)


def test_what_stands_decides_on_which_pallet(answers) -> None:
    pallets = (StandingPallet(PALLET, (TALL,)), StandingPallet(SECOND_PALLET))
    assert answers.answer(question(pallets, known=(item("a"),))).pallet == SECOND_PALLET


def test_a_box_that_was_set_aside_comes_first(answers) -> None:
    answer = answers.answer(question(buffered=(item("aside"),), known=(item("a"),), room=1))
    assert (answer.step, answer.item) == (NextStep.PLACE, "aside")


@pytest.mark.parametrize(("room", "step"), [(1, NextStep.SET_ASIDE), (0, NextStep.CLOSE)])
def test_where_nothing_fits_it_is_set_aside_while_there_is_room(answers, room: int, step) -> None:
    full = tuple(StandingPallet(place, (COVERED,)) for place in CELL.pallets)
    assert answers.answer(question(full, known=(item("a"),), room=room)).step is step


@pytest.mark.parametrize(("missed", "step"), [(4, NextStep.PLACE), (5, NextStep.CLOSE)])
def test_a_pallet_that_several_boxes_missed_is_closed(answers, missed: int, step) -> None:
    pallets = (StandingPallet(PALLET, (TALL,), missed), StandingPallet(SECOND_PALLET))
    answer = answers.answer(question(pallets, known=(item("a"),)))
    assert answer.step is step
    assert answer.pallet == (SECOND_PALLET if step is NextStep.PLACE else PALLET)


def test_a_box_that_the_gripper_cannot_hold_is_rejected(answers) -> None:
    answer = answers.answer(question(known=(item("lead", weight=200.0),)))
    assert (answer.step, answer.item) == (NextStep.REJECT, "lead")
