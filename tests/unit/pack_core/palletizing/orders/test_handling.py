"""The turn of a box: which of its sides lie where, and what it takes to get them there."""

from __future__ import annotations

from itertools import product

import pytest

from pack_core.palletizing.orders.handling import BundlingAxis, Handling, OrientId, turn_of
from pack_core.palletizing.orders.order_file import load_order
from pack_core.paths import config_path

DIMS = (0.6, 0.4, 0.2)
AXES: tuple[BundlingAxis, ...] = ("z", "y")
IDS: tuple[OrientId, ...] = (0, 1, 2, 3, 4, 5)
BYPASSES = {
    ("z", 0): Handling.NONE,
    ("y", 5): Handling.NONE,
    ("z", 4): Handling.FLIP,
    ("y", 2): Handling.FLIP,
}


@pytest.mark.parametrize(("axis", "orient_id"), list(product(AXES, IDS)))
def test_a_bypass_of_the_table_leaves_the_box_lying_and_the_table_stands_it_up(
    axis: BundlingAxis, orient_id: OrientId
) -> None:
    turn = turn_of(DIMS, axis, orient_id)
    assert sorted(turn.extents, reverse=True) == list(DIMS)
    assert (turn.extents[2] == DIMS[2]) is (turn.handling is not Handling.TABLE)


@pytest.mark.parametrize("axis", AXES)
def test_the_six_ids_of_an_axis_are_the_six_ways_to_lie(axis: BundlingAxis) -> None:
    assert len({turn_of(DIMS, axis, orient_id).extents for orient_id in IDS}) == 6


@pytest.mark.parametrize(("axis", "orient_id"), list(product(AXES, IDS)))
def test_the_two_bypasses_are_those_of_the_thesis(axis: BundlingAxis, orient_id: OrientId) -> None:
    assert turn_of(DIMS, axis, orient_id).handling == BYPASSES.get((axis, orient_id), Handling.TABLE)


@pytest.mark.parametrize(
    ("dims", "axis", "orient_id", "handling"),
    [
        ((0.4, 0.4, 0.2), "z", 4, Handling.NONE),
        ((0.4, 0.4, 0.2), "y", 2, Handling.NONE),
        ((0.4, 0.2, 0.2), "z", 5, Handling.NONE),
        ((0.4, 0.2, 0.2), "z", 2, Handling.FLIP),
        ((0.4, 0.2, 0.2), "z", 3, Handling.TABLE),
        ((0.3, 0.3, 0.3), "y", 1, Handling.NONE),
    ],
)
def test_equal_sides_are_handled_the_cheapest_way(
    dims: tuple[float, float, float], axis: BundlingAxis, orient_id: OrientId, handling: Handling
) -> None:
    turn = turn_of(dims, axis, orient_id)
    assert turn.handling is handling
    assert sorted(turn.extents, reverse=True) == list(dims)


def test_the_25_orders_use_every_axis_and_id() -> None:
    orders = [load_order(path) for path in config_path("orders").glob("*.json")]
    boxes = [item for order in orders for item in order.boxes]
    assert {(item.bundling_axis, item.orient_id) for item in boxes} == set(product(AXES, IDS))
    counts = [sum(item.turn.handling is handling for item in boxes) for handling in Handling]
    assert counts == [66, 58, 82]
