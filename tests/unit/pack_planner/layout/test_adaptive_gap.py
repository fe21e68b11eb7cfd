"""The gap adapts to the layout (Eq. 6.7)."""

from __future__ import annotations

import pytest

from pack_core.palletizing.orders.layout_plan import LayoutStatus
from pack_core.palletizing.orders.order_file import load_order
from pack_core.paths import config_path
from pack_planner.layout.layout_planner import LayoutConfig, LayoutPlanner
from pack_planner.layout.pallet_separator import SeparatorConfig, smallest_gap


def planner(**separator: float) -> LayoutPlanner:
    return LayoutPlanner(LayoutConfig(separator=SeparatorConfig(**separator)))


@pytest.mark.parametrize(("number", "gap_mm"), [(11, 10.0), (13, 2.0)])
def test_it_grows_to_ten_millimetres_where_there_is_room_and_stays_small_where_there_is_none(
    number: int, gap_mm: float
) -> None:
    plan = planner(widest_gap=0.010).plan(load_order(config_path("orders", f"order_{number}.json")))
    assert plan.status is LayoutStatus.SUCCESS
    assert 1e3 * plan.gap == pytest.approx(gap_mm)
    assert 1e3 * smallest_gap([entry.placed for entry in plan.boxes]) >= gap_mm - 0.01


def test_it_shrinks_to_what_still_fits_rather_than_refuse_the_order() -> None:
    order = load_order(config_path("orders", "order_13.json"))
    strict = planner(gap=0.004, least_gap=0.004, widest_gap=0.004, max_margin=0.0).plan(order)
    assert strict.status is LayoutStatus.INFEASIBLE
    assert "no gap of 4 mm" in strict.reason
    yields = planner(gap=0.004, least_gap=0.0, widest_gap=0.004, max_margin=0.0).plan(order)
    assert yields.status is LayoutStatus.SUCCESS
    assert yields.gap < 0.004


def test_a_gap_that_is_asked_for_is_taken_as_it_is() -> None:
    order = load_order(config_path("orders", "order_11.json"))
    assert planner(widest_gap=0.010).plan(order, 0.003).gap == 0.003
