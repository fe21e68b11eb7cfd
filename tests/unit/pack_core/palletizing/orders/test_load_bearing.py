"""What boxes carry: closed forms, and the boxes that carry more than they may."""

from __future__ import annotations

import numpy as np
import pytest

from pack_core.palletizing.orders.load_bearing import carried_loads, overloaded_boxes
from pack_core.palletizing.orders.placed_box import PlacedBox
from pack_core.palletizing.orders.stack import GRAVITY


def box(
    name: str, lower: tuple[float, ...], size: tuple[float, ...], mass: float, **limits: float
) -> PlacedBox:
    return PlacedBox(name, np.array(lower), np.array(size), mass, **limits)


def column(**limits: float) -> list[PlacedBox]:
    """Three boxes of 2, 3 and 5 kg on each other, from above, the lowest one with limits."""
    return [
        box("top", (0, 0, 0.4), (0.2, 0.2, 0.2), 5.0),
        box("middle", (0, 0, 0.2), (0.4, 0.4, 0.2), 3.0),
        box("bottom", (0, 0, 0), (0.4, 0.4, 0.2), 2.0, **limits),
    ]


def test_a_column_carries_all_that_is_above() -> None:
    loads = carried_loads(column())
    assert [loads[name][0] for name in ("top", "middle", "bottom")] == pytest.approx([0.0, 5.0, 8.0])
    assert loads["middle"][1] == pytest.approx(5.0 * GRAVITY / 0.04 / 1e3)
    assert loads["bottom"][1] == pytest.approx(8.0 * GRAVITY / 0.16 / 1e3)


def test_weight_is_shared_by_contact_area_and_none_is_lost() -> None:
    """A box over two others, three quarters of it on one of them."""
    stack = [
        box("wide", (0, 0, 0), (0.3, 0.4, 0.2), 1.0), box("narrow", (0.3, 0, 0), (0.1, 0.4, 0.2), 1.0),
        box("over", (0, 0, 0.2), (0.4, 0.4, 0.2), 8.0), box("heavy", (0, 0, 0.4), (0.4, 0.4, 0.2), 4.0),
    ]  # fmt: skip
    loads = carried_loads(stack)
    assert loads["wide"][0] == pytest.approx(9.0)
    assert loads["narrow"][0] == pytest.approx(3.0)


@pytest.mark.parametrize(
    ("limits", "reason"),
    [
        ({"max_load": 7.9}, "it carries 8.0 kg; allowed: 7.9 kg (max_load)"),
        ({"max_load": 0.0}, "it carries 8.0 kg; allowed: 0 kg (max_load)"),
        ({"max_pressure": 0.4}, "0.49 kPa press on its top; allowed: 0.4 kPa (max_pressure)"),
    ],
)
def test_the_overloaded_box_is_named(limits: dict[str, float], reason: str) -> None:
    assert overloaded_boxes(column(**limits)) == {"bottom": reason}


def test_a_limit_that_is_just_kept_is_kept() -> None:
    assert overloaded_boxes(column(max_load=8.0, max_pressure=8.0 * GRAVITY / 160.0)) == {}
