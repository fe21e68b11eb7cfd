"""The turn of a box: its rotation brings its sides where its extents say they are."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

from pack_core.orders.handling import BundlingAxis, Handling, OrientId, turn_of
from pack_core.orders.order_file import load_order
from pack_core.paths import config_path
from pack_core.rotations import rotate, to_matrix

DIMS = (0.6, 0.4, 0.2)
AXES: tuple[BundlingAxis, ...] = ("z", "y")
IDS: tuple[OrientId, ...] = (0, 1, 2, 3, 4, 5)
BYPASSES = {
    ("z", 0): Handling.NONE,
    ("y", 5): Handling.NONE,
    ("z", 4): Handling.FLIP,
    ("y", 2): Handling.FLIP,
}
TOOL_AXIS = np.array([0.0, 0.0, 1.0])


@pytest.mark.parametrize(("axis", "orient_id"), list(product(AXES, IDS)))
def test_the_tool_turns_the_box_to_its_extents(axis: BundlingAxis, orient_id: OrientId) -> None:
    turn = turn_of(DIMS, axis, orient_id)
    np.testing.assert_allclose(np.abs(to_matrix(turn.q_box)) @ DIMS, turn.extents, atol=1e-12)


@pytest.mark.parametrize("axis", AXES)
def test_the_six_ids_of_an_axis_are_the_six_ways_to_lie(axis: BundlingAxis) -> None:
    assert len({turn_of(DIMS, axis, orient_id).extents for orient_id in IDS}) == 6


@pytest.mark.parametrize(("axis", "orient_id"), list(product(AXES, IDS)))
def test_the_two_bypasses_are_those_of_the_thesis(axis: BundlingAxis, orient_id: OrientId) -> None:
    assert turn_of(DIMS, axis, orient_id).handling == BYPASSES.get((axis, orient_id), Handling.TABLE)


@pytest.mark.parametrize(("axis", "orient_id"), list(product(AXES, IDS)))
def test_boxes_are_put_down_from_above_and_stood_up_from_the_side(
    axis: BundlingAxis, orient_id: OrientId
) -> None:
    turn = turn_of(DIMS, axis, orient_id)
    np.testing.assert_allclose(rotate(turn.q_place, TOOL_AXIS), [0, 0, -1], atol=1e-12)
    approach = rotate(turn.q_reorient, TOOL_AXIS)
    if turn.handling is Handling.TABLE:
        assert np.allclose(approach, [1, 0, 0]) or np.allclose(approach, [0, 1, 0])
    else:
        np.testing.assert_allclose(approach, [0, 0, -1], atol=1e-12)


def test_the_untouched_box_is_not_turned() -> None:
    np.testing.assert_allclose(turn_of(DIMS, "z", 0).q_box, [1, 0, 0, 0], atol=1e-12)


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
    np.testing.assert_allclose(np.abs(to_matrix(turn.q_box)) @ dims, turn.extents, atol=1e-12)


def test_the_25_orders_use_every_axis_and_id() -> None:
    orders = [load_order(path) for path in config_path("orders").glob("*.json")]
    boxes = [item for order in orders for item in order.boxes]
    assert {(item.bundling_axis, item.orient_id) for item in boxes} == set(product(AXES, IDS))
    counts = [sum(item.turn.handling is handling for item in boxes) for handling in Handling]
    assert counts == [66, 58, 82]
