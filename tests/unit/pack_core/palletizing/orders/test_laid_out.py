"""An order's file with the boxes at their places in a layout (Sec. 6.2 of the thesis)."""

import numpy as np
import pytest

from pack_core.palletizing.orders.layout_plan import (
    Insertion,
    LayoutPlan,
    LayoutStatus,
    PlannedBox,
    laid_out,
)
from pack_core.palletizing.orders.order_file import load_order, parse_order
from pack_core.paths import config_path

ORDER = load_order(config_path("orders", "order_09.json"))
SHIFT = np.array([0.001, 0.004, 0.0])
EAST = Insertion("East", np.array([1.0, 0.0, 0.0]), 0.25)


def plan() -> LayoutPlan:
    """All boxes shifted alike, the last one first."""
    boxes = tuple(PlannedBox(item.moved(SHIFT), EAST) for item in reversed(ORDER.placed))
    return LayoutPlan(LayoutStatus.SUCCESS, "", boxes, 0.002, 0.0)


def test_boxes_stand_at_their_new_places_in_the_sequence_of_placing() -> None:
    written = laid_out(ORDER, plan())
    assert [box.id for box in written.boxes] == [box.id for box in reversed(ORDER.boxes)]
    assert [box.seq for box in written.boxes] == [1, 2, 3]
    for box in written.boxes:
        assert np.array(box.position) - ORDER.box(box.id).position == pytest.approx(SHIFT)


def test_all_else_of_a_box_stays() -> None:
    for box in laid_out(ORDER, plan()).boxes:
        before = ORDER.box(box.id)
        assert box.model_copy(update={"position": before.position, "seq": before.seq}) == before


def test_the_file_says_where_boxes_come_from_and_can_be_read_as_an_order() -> None:
    written = parse_order(laid_out(ORDER, plan()).model_dump_json(exclude_none=True), "here")
    layout = written.source["layout"]
    assert (layout["gap"], layout["virtual_margin"]) == (0.002, 0.0)
    assert layout["insertions"][ORDER.boxes[0].id] == {"from": "East", "corridor": 0.25}
    assert written.source["dataset"] == ORDER.source["dataset"]
