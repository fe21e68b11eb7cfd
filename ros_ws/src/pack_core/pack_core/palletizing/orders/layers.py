"""Layers of a layout: boxes whose bases are at the same height."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby

from pack_core.palletizing.orders.placed_box import PlacedBox

STEP = 0.001
"""Heights of bases are rounded to multiples of this; equal ones are in one layer [m]."""


def layers_of(boxes: Sequence[PlacedBox]) -> list[tuple[PlacedBox, ...]]:
    """The layers from the deck upwards."""
    by_height = sorted(boxes, key=_height)
    return [tuple(layer) for _, layer in groupby(by_height, key=_height)]


def _height(item: PlacedBox) -> int:
    return round(float(item.lower[2]) / STEP)
