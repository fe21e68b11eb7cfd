"""Boxes that are drawn from a list bear what the list says, unless all are given another limit."""

from __future__ import annotations

import pytest

from pack_core.palletizing.orders.box_stream import box_stream
from pack_core.palletizing.orders.item_list import Item

LISTED = Item(
    id="a", article="a", size=(0.4, 0.3, 0.2), weight=5.0, this_side_up=False, max_load=30.0, max_pressure=2.0
)


@pytest.mark.parametrize(("given", "expected"), [(None, 2.0), (1.5, 1.5)])
def test_the_listed_pressure_holds_unless_another_is_given(given: float | None, expected: float) -> None:
    box, _ = next(box_stream([LISTED], 0, given))
    assert (box.max_load, box.max_pressure) == (30.0, expected)
