"""Gaps are reached by the least displacement, shared by free margin, and stacks move as one."""

from __future__ import annotations

from itertools import product
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pack_core.palletizing.orders.order_file import load_order
from pack_core.palletizing.orders.placed_box import PlacedBox
from pack_core.palletizing.orders.support import SupportConfig, unstable_boxes
from pack_core.paths import config_path
from pack_core.rotations import Array
from pack_planner.layout.axis_program import AxisProgram
from pack_planner.layout.pallet_separator import (
    PalletSeparator,
    Separation,
    SeparatorConfig,
    neighbours,
    smallest_gap,
    support_shares,
)
from unit.pack_planner.layout.blocks import PALLET, block, grids, row

GAP = 0.01
ORDERS = sorted(config_path("orders").glob("*.json"))


def separate(boxes: list[PlacedBox], gap: float = GAP, **fields: float) -> Separation:
    return PalletSeparator(PALLET, SeparatorConfig(**fields)).separate(boxes, gap)


def test_two_boxes_share_the_correction_by_their_free_margins() -> None:
    separation = separate(row(0.2, 0.5))  # 0.2 m free on the left, 0.4 m on the right
    np.testing.assert_allclose(separation.displacements[:, 0], [-GAP / 3, GAP * 2 / 3], atol=1e-9)
    np.testing.assert_allclose(separation.displacements[:, 1], 0.0, atol=1e-12)


def test_a_box_at_the_border_leaves_the_whole_correction_to_the_other() -> None:
    separation = separate(row(0.0, 0.3))
    np.testing.assert_allclose(separation.displacements[:, 0], [0.0, GAP], atol=1e-9)


def test_the_axis_that_needs_less_is_taken() -> None:
    boxes = [block("a", 0.2, 0.2), block("b", 0.508, 0.394)]  # 8 mm apart in x, overlapping by 6 mm in y
    separation = separate(boxes)
    np.testing.assert_allclose(separation.displacements[:, 1], 0.0, atol=1e-12)
    assert np.abs(separation.displacements[:, 0]).sum() == pytest.approx(0.002)


def test_a_gap_that_is_there_already_moves_nothing() -> None:
    separation = separate(row(0.1, 0.41, 0.8))
    np.testing.assert_allclose(separation.displacements, 0.0, atol=1e-12)
    assert separation.gap == pytest.approx(GAP)


def test_a_full_row_uses_the_virtual_margin_and_no_more_of_it_than_it_must() -> None:
    separation = separate(row(0.0, 0.3, 0.6, 0.9))
    assert separation.is_feasible
    assert separation.virtual_margin == pytest.approx(1.5 * GAP)
    assert min(item.lower[0] for item in separation.boxes) == pytest.approx(-1.5 * GAP, abs=1e-6)


def test_what_cannot_be_parted_is_left_alone_and_told() -> None:
    separation = separate(row(0.0, 0.3, 0.6, 0.9), max_margin=0.01)
    assert not separation.is_feasible
    assert not separation.is_minimal
    assert separation.gap == pytest.approx(0.0, abs=1e-9)
    assert separation.virtual_margin == 0.01
    np.testing.assert_array_equal(separation.displacements, np.zeros((4, 2)))


@pytest.mark.parametrize(("max_margin", "is_feasible"), [(0.015, True), (0.014, False)])
def test_the_virtual_margin_grows_up_to_its_bound(max_margin: float, is_feasible: bool) -> None:
    assert separate(row(0.0, 0.3, 0.6, 0.9), max_margin=max_margin).is_feasible is is_feasible


@pytest.mark.parametrize(("max_shift", "is_feasible"), [(1.6, True), (1.4, False)])
def test_no_box_is_displaced_further_than_so_many_gaps(max_shift: float, is_feasible: bool) -> None:
    """Both are 20 mm into each other, 30 mm short of the gap."""
    assert separate(row(0.4, 0.68), max_shift=max_shift).is_feasible is is_feasible


def test_a_box_across_two_others_is_carried_by_its_share_of_area_on_each() -> None:
    below = [block("a", 0.2, 0.2, (0.1, 0.2, 0.2)), block("b", 0.3, 0.2, (0.3, 0.2, 0.2))]
    boxes = [*below, block("top", 0.2, 0.2, (0.3, 0.2, 0.2), z=0.2)]
    expected = np.zeros((3, 3))
    expected[2] = [1 / 3, 2 / 3, 0.0]
    np.testing.assert_allclose(support_shares(boxes), expected, atol=1e-12)


def program(**fields: object) -> AxisProgram:
    """Two boxes of 0.3 m that touch, with 0.2 m free before them and 0.4 m behind."""
    lower = np.array([0.2, 0.5])
    given = dict(lower=lower, upper=lower + 0.3, follow=np.zeros((2, 2)), length=1.2, gap=GAP)
    return AxisProgram(**given | {"overhang": 0.0, "max_shift": 0.05} | fields)


def test_the_cost_of_parting_two_boxes_is_the_squared_gap_over_both_margins() -> None:
    displacements, cost = program().solve([(0, 1)])
    np.testing.assert_allclose(displacements, [-GAP / 3, GAP * 2 / 3], atol=1e-9)
    assert cost == pytest.approx(GAP**2 / (0.2 + 0.4))
    assert program(overhang=0.1).solve([(0, 1)])[1] == pytest.approx(GAP**2 / (0.3 + 0.5))


def test_without_relations_nothing_is_displaced() -> None:
    displacements, cost = program().solve([])
    np.testing.assert_allclose(displacements, 0.0, atol=1e-12)
    assert cost == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize(
    ("fields", "relations"),
    [
        ({"max_shift": 0.49 * GAP}, [(0, 1)]),
        ({}, [(0, 1), (1, 0)]),
        ({}, [(1, 0)]),
        ({"lower": np.array([0.0, 0.3]), "upper": np.array([0.3, 0.6]), "length": 0.6}, [(0, 1)]),
    ],
    ids=["reach", "contradiction", "swap beyond reach", "no room"],
)
def test_relations_that_cannot_be_fulfilled_have_no_displacements(fields: dict, relations: list) -> None:
    assert program(**fields).solve(relations) is None


def test_what_rests_on_a_box_follows_it_at_no_cost() -> None:
    lower = np.array([0.2, 0.5, 0.2])
    follow = np.zeros((3, 3))
    follow[2, 0] = 1.0
    displacements, cost = program(lower=lower, upper=lower + 0.3, follow=follow).solve([(0, 1)])
    np.testing.assert_allclose(displacements, [-GAP / 3, GAP * 2 / 3, -GAP / 3], atol=1e-9)
    assert cost == pytest.approx(GAP**2 / 0.6)


def test_boxes_of_different_height_that_reach_into_each_other_are_parted() -> None:
    boxes = [
        block("tall", 0.1, 0.3, (0.3, 0.3, 0.4)),
        block("base", 0.41, 0.3),
        block("top", 0.4, 0.3, z=0.2),
    ]
    separation = separate(boxes)
    assert separation.boxes[2].clearance(separation.boxes[0])[0] == pytest.approx(GAP, abs=1e-7)


@settings(max_examples=40)
@given(boxes=grids(), gap_mm=st.integers(1, 10))
def test_every_gap_is_reached_and_heights_and_sizes_stay(boxes: list[PlacedBox], gap_mm: int) -> None:
    separation = separate(boxes, gap_mm * 1e-3)
    assert separation.is_feasible
    assert smallest_gap(separation.boxes) >= gap_mm * 1e-3 - 1e-7
    for before, after in zip(boxes, separation.boxes, strict=True):
        assert after.lower[2] == before.lower[2]
        assert np.all(after.lower[:2] > -separation.virtual_margin - 1e-7)
        assert np.all(after.upper[:2] < np.array([1.2, 0.8]) + separation.virtual_margin + 1e-7)


@settings(max_examples=40)
@given(boxes=grids(), gap_mm=st.integers(1, 10))
def test_a_stack_moves_as_one(boxes: list[PlacedBox], gap_mm: int) -> None:
    separation = separate(boxes, gap_mm * 1e-3)
    shift = {item.id: shift for item, shift in zip(boxes, separation.displacements, strict=True)}
    for name in shift:
        if name.endswith("top"):
            np.testing.assert_allclose(shift[name], shift[name.removesuffix(" top")], atol=1e-7)


TRIPLES = [
    [block("a", 0.3, 0.2), block("b", 0.6, 0.2), block("c", 0.45, 0.4)],
    [block("a", 0.3, 0.2), block("b", 0.6, 0.4), block("c", 0.6, 0.2)],
    [block("a", 0.0, 0.2), block("b", 0.29, 0.4), block("c", 0.3, 0.2)],
]


@pytest.mark.parametrize("boxes", TRIPLES, ids=["bridge", "corner", "border"])
def test_no_displacement_on_a_fine_grid_is_cheaper(boxes: list[PlacedBox]) -> None:
    separation = separate(boxes)
    assert separation.is_minimal
    steps = np.linspace(-GAP, GAP, 9)
    shifts = np.array(list(product(steps, repeat=6))).reshape(-1, 3, 2)
    shifts = shifts[_are_apart(boxes, shifts, separation.virtual_margin)]
    assert len(shifts) > 100
    cheapest = _costs(boxes, shifts, separation.virtual_margin).min()
    found = _costs(boxes, separation.displacements[None], separation.virtual_margin)[0]
    assert 0.0 < found <= cheapest + 1e-12


def _are_apart(boxes: list[PlacedBox], shifts: Array, margin: float) -> Array:
    lower = np.array([item.lower[:2] for item in boxes]) + shifts
    upper = np.array([item.upper[:2] for item in boxes]) + shifts
    is_on = np.all((lower > -margin - 1e-9) & (upper < np.array([1.2, 0.8]) + margin + 1e-9), axis=(1, 2))
    for i, j in neighbours(boxes):
        gaps = np.maximum(lower[:, i] - upper[:, j], lower[:, j] - upper[:, i]).max(axis=-1)
        is_on &= gaps >= GAP - 1e-9
    return np.asarray(is_on)


def _costs(boxes: list[PlacedBox], shifts: Array, margin: float) -> Array:
    """What the separator minimises for boxes on the deck, written down anew, in squared metres a metre."""
    left = np.array([item.lower[:2] for item in boxes]) + margin
    right = np.array([1.2, 0.8]) + margin - np.array([item.upper[:2] for item in boxes])
    free = np.where(shifts > 0.0, right, left)
    return np.asarray((shifts**2 / np.where(np.abs(shifts) > 1e-9, free, 1.0)).sum(axis=(1, 2)))


@pytest.mark.parametrize("path", ORDERS, ids=lambda path: path.stem)
def test_the_25_orders_get_their_gaps_and_still_stand(path: Path) -> None:
    order = load_order(path)
    separation = PalletSeparator(order.pallet, SeparatorConfig()).separate(order.placed)
    assert separation.is_feasible
    assert separation.is_minimal
    assert separation.gap >= SeparatorConfig().gap - 1e-7
    assert unstable_boxes(separation.boxes, SupportConfig()) == {}
    assert separation.virtual_margin <= 0.001
