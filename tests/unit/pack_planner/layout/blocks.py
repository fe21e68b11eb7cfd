"""Small layouts for the tests."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st

from pack_core.palletizing.orders.order import OrderPallet
from pack_core.palletizing.orders.placed_box import PlacedBox

PALLET = OrderPallet(length=1.2, width=0.8, deck_height=0.144)


def block(
    name: str, x: float, y: float, size: tuple[float, float, float] = (0.3, 0.2, 0.2), z: float = 0.0
) -> PlacedBox:
    """A box with its lower corner at (x, y, z)."""
    return PlacedBox(name, np.array([x, y, z]), np.array(size), 5.0)


def row(*xs: float) -> list[PlacedBox]:
    """Boxes of 0.3 m side by side along x."""
    return [block(f"b{k}", x, 0.3) for k, x in enumerate(xs)]


@st.composite
def grids(draw: st.DrawFn) -> list[PlacedBox]:
    """Up to 3 x 2 touching boxes on the deck, each with perhaps another on top, somewhere on the pallet."""
    widths = draw(st.lists(st.integers(10, 30), min_size=1, max_size=3))
    depths = draw(st.lists(st.integers(10, 30), min_size=1, max_size=2))
    x, y = draw(st.integers(0, 120 - sum(widths))) / 100, draw(st.integers(0, 80 - sum(depths))) / 100
    boxes = []
    for i, width in enumerate(widths):
        for j, depth in enumerate(depths):
            size = (width / 100, depth / 100, 0.2)
            corner = (x + sum(widths[:i]) / 100, y + sum(depths[:j]) / 100)
            boxes.append(block(f"{i}{j}", *corner, size))
            if draw(st.booleans()):
                boxes.append(block(f"{i}{j} top", *corner, size, z=0.2))
    return boxes
