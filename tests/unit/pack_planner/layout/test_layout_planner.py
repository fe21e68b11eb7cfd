"""The whole of it: places, sequence and directions of real orders, refusals in words."""

from __future__ import annotations

import numpy as np
import pytest

from pack_core.errors import PackError
from pack_core.palletizing.orders.layout_plan import LayoutStatus, layers_of
from pack_core.palletizing.orders.order import Order
from pack_core.palletizing.orders.order_file import load_order
from pack_core.palletizing.orders.placed_box import PlacedBox
from pack_core.palletizing.orders.stack import GRAVITY
from pack_core.paths import config_path
from pack_planner.layout.layout_planner import LayoutConfig, LayoutPlanner, overlapping
from pack_planner.layout.pallet_separator import SeparatorConfig
from unit.pack_planner.layout.blocks import block

PLANNER = LayoutPlanner(LayoutConfig())


def order(number: int) -> Order:
    return load_order(config_path("orders", f"order_{number:02d}.json"))


@pytest.mark.parametrize("number", [5, 11, 13, 25])
def test_each_box_comes_free_of_those_before_it_and_every_box_is_placed(number: int) -> None:
    plan = PLANNER.plan(order(number))
    assert plan.status is LayoutStatus.SUCCESS, plan.reason
    assert sorted(item.placed.id for item in plan.boxes) == sorted(item.id for item in order(number).boxes)
    earlier: list[PlacedBox] = []
    for item in plan.boxes:
        start = item.placed.moved(item.insertion.corridor * item.insertion.outward)
        for other in earlier:
            assert not item.placed.overlaps(other)
            assert not start.overlaps(other)
            assert not other.is_over(item.placed)
        earlier.append(item.placed)


def test_dense_orders_need_directions_and_scattered_ones_none() -> None:
    assert {item.insertion.direction for item in PLANNER.plan(order(1)).boxes} == {"Center"}
    assert sum(item.insertion.direction != "Center" for item in PLANNER.plan(order(13)).boxes) >= 8


def test_a_gap_that_cannot_be_had_is_told() -> None:
    config = LayoutConfig(separator=SeparatorConfig(max_margin=0.0))
    plan = LayoutPlanner(config).plan(order(13), 0.01)
    assert plan.status is LayoutStatus.INFEASIBLE
    assert "no gap of 10 mm" in plan.reason
    assert plan.boxes == ()


def test_gaps_that_leave_a_box_without_its_support_are_told_by_its_name() -> None:
    """A box that just rests on its base has to give way to a neighbour at the pallet's border."""
    data = order(3).model_dump(exclude={"boxes", "total_boxes", "total_weight", "stack_height"})
    common = {"weight": 5.0, "bundling_axis": "z"}
    data["boxes"] = [
        {**common, "id": "slab", "dims": (0.3, 0.1, 0.08), "orient_id": 2, "position": (1.12, 0.1, 0.0)},
        {**common, "id": "base", "dims": (0.3, 0.3, 0.1), "orient_id": 0, "position": (0.8, 0.1, 0.0)},
        {**common, "id": "edge", "dims": (0.3, 0.1, 0.1), "orient_id": 4, "position": (1.1, 0.1, 0.1)},
        {**common, "id": "upper", "dims": (0.42, 0.3, 0.1), "orient_id": 0, "position": (0.68, 0.1, 0.1)},
    ]
    leaning = Order.model_validate(data)
    assert PLANNER.plan(leaning, 0.001).status is LayoutStatus.SUCCESS
    plan = PLANNER.plan(leaning, 0.02)
    assert plan.status is LayoutStatus.UNSTABLE
    assert plan.reason.startswith("with gaps of 20 mm: box 'upper': 69.2% of its base is carried")


@pytest.mark.parametrize("gap", [-0.001, 0.06, float("nan")])
def test_a_gap_that_is_no_gap_is_refused(gap: float) -> None:
    with pytest.raises(PackError, match=r"allowed: 0 to 0\.05 m"):
        PLANNER.plan(order(3), gap)


def test_the_same_order_gets_the_same_plan() -> None:
    first, second = PLANNER.plan(order(11)), PLANNER.plan(order(11))
    for a, b in zip(first.boxes, second.boxes, strict=True):
        assert a.insertion.direction == b.insertion.direction
        np.testing.assert_array_equal(a.placed.lower, b.placed.lower)


def test_layers_are_boxes_with_their_bases_at_one_height() -> None:
    boxes = [block("top", 0, 0, z=0.2), block("a", 0, 0), block("b", 0.3, 0.0, z=0.0004)]
    assert [[item.id for item in layer] for layer in layers_of(boxes)] == [["a", "b"], ["top"]]


def test_boxes_that_share_space_are_named_in_pairs() -> None:
    apart, beside, within = block("apart", 0.9, 0.3), block("beside", 0.3, 0.3), block("within", 0.35, 0.3)
    assert overlapping([apart, beside, within]) == [("beside", "within")]
    assert overlapping([apart, beside]) == []


def test_gaps_that_let_a_box_press_on_less_of_its_base_are_told_where_that_is_too_much() -> None:
    """A box over two others presses harder once these are parted, by the share of its base that is lost."""
    data = order(3).model_dump(exclude={"boxes", "total_boxes", "total_weight", "stack_height"})
    common = {"weight": 5.0, "bundling_axis": "z", "orient_id": 0}
    base = {**common, "dims": (0.3, 0.3, 0.1), "max_pressure": 5.0 * GRAVITY / 0.18e3 * 1.005}
    data["boxes"] = [
        {**base, "id": "left", "position": (0.2, 0.2, 0.0)},
        {**base, "id": "right", "position": (0.5, 0.2, 0.0)},
        {**common, "id": "over", "dims": (0.6, 0.3, 0.1), "position": (0.2, 0.2, 0.1)},
    ]
    assert PLANNER.plan(Order.model_validate(data), 0.0).status is LayoutStatus.SUCCESS
    plan = PLANNER.plan(Order.model_validate(data), 0.01)
    assert plan.status is LayoutStatus.UNSTABLE
    assert "box 'left': 0.28 kPa press on its top" in plan.reason
