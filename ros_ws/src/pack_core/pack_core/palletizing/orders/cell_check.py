"""Checks whether a cell can build an order: the size of its pallet, and the limits of its gripper."""

from __future__ import annotations

from collections.abc import Iterator

from pack_core.palletizing.cell import PalletizingCell
from pack_core.palletizing.orders.grips import grips_of
from pack_core.palletizing.orders.order import Order, OrderBox

TOLERANCE = 0.001
"""An order's pallet may differ from the cell's by this [m]."""
WHERE = "config/cells/palletizing.yaml"


def misfits_of(order: Order, cell: PalletizingCell) -> list[str]:
    """Every reason why this cell cannot build the order; empty where it can."""
    return [*_wrong_pallet(order, cell), *(why for item in order.boxes for why in _not_held(item, cell))]


def _wrong_pallet(order: Order, cell: PalletizingCell) -> Iterator[str]:
    own = dict(zip(("length", "width"), cell.pallet.size, strict=True))
    for key, allowed in {**own, "deck_height": cell.pallet.deck_height}.items():
        given = getattr(order.pallet, key)
        if abs(given - allowed) > TOLERANCE:
            yield f"key 'pallet.{key}' is {given:g}; allowed: {allowed:g}, the cell's ({WHERE}: pallet)"


def _not_held(item: OrderBox, cell: PalletizingCell) -> Iterator[str]:
    """For each limit of the gripper that is exceeded, the first grip that exceeds it."""
    reasons: dict[str, str] = {}
    seals = cell.tool.seals()
    for grip in grips_of(item, cell.grip.carrying_acceleration):
        # Seals are ordered from the largest to the smallest: the first that fits the face is used.
        seal = next((seal for seal in seals if seal.side <= grip.face), seals[-1])
        for passed in cell.grip.passed_by(grip.load, seal.share):
            key, unit = passed.key, passed.unit
            text = f"{item.weight:g} kg, {grip.how}, make a {passed.what} of {passed.load:.1f} {unit}"
            reasons.setdefault(key, f"{text}; allowed: {passed.allowed:g} {unit} ({WHERE}: grip.{key})")
        if grip.face < seal.side:
            text = f"its face is {grip.face:g} m wide where it is {grip.how}"
            reasons.setdefault("face", f"{text}; allowed: {seal.side:g} m ({WHERE}: {seal.key})")
    return (f"box '{item.id}': {reason}" for reason in reasons.values())
