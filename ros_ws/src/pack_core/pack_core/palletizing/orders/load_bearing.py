"""Which boxes carry more than they may: the weight that flows down onto each, and the pressure on its top."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pack_core.palletizing.orders.placed_box import PlacedBox
from pack_core.palletizing.orders.stack import pressure_under, stack_of
from pack_core.rotations import Array

ROUNDING = 1e-6
"""A limit counts as kept up to this share of it."""


def carried_loads(boxes: Sequence[PlacedBox]) -> dict[str, tuple[float, float]]:
    """What each box carries [kg] and the largest pressure on its top [kPa], by name."""
    stack, from_below = stack_of(boxes)
    pressures: Array = np.zeros(len(boxes))
    for i in range(len(boxes)):
        for k in range(stack.first[i], stack.first[i + 1]):
            pressure = pressure_under(stack.loads[i, 0], stack.areas[i])
            pressures[stack.under[k]] = max(pressures[stack.under[k]], pressure)
    carried = stack.loads[:, 0] - stack.masses
    return {box.id: (float(carried[i]), float(pressures[i])) for i, box in enumerate(from_below)}


def overloaded_boxes(boxes: Sequence[PlacedBox]) -> dict[str, str]:
    """The names of the boxes that carry more than they may, and the reason for each."""
    loads, found = carried_loads(boxes), {}
    for box in boxes:
        load, pressure = loads[box.id]
        if load > box.max_load * (1.0 + ROUNDING) + ROUNDING:
            found[box.id] = f"it carries {load:.1f} kg; allowed: {box.max_load:g} kg (max_load)"
        elif pressure > box.max_pressure * (1.0 + ROUNDING):
            allowed = f"{box.max_pressure:g} kPa (max_pressure)"
            found[box.id] = f"{pressure:.2f} kPa press on its top; allowed: {allowed}"
    return found
