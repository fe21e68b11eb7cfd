"""Finds everything that is wrong with an order: in itself, and for the pallet and the gripper of a cell."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice

import numpy as np

from pack_core.palletizing.cell import PalletizingCell
from pack_core.palletizing.grip import GripLoad
from pack_core.palletizing.orders.handling import Handling
from pack_core.palletizing.orders.load_bearing import overloaded_boxes
from pack_core.palletizing.orders.order import Order, OrderBox
from pack_core.palletizing.orders.placed_box import TOUCH
from pack_core.palletizing.orders.stack import GRAVITY
from pack_core.palletizing.orders.support import SupportConfig, unstable_boxes

TALLEST = 2.5
"""Of a stack over the deck: a lorry's door is 2.7 m high [m]."""
MOST_OVERLAPS = 1000
"""Pairs that are looked for; where all boxes are at one place, there are n^2 / 2."""
ROUNDING = 0.01
"""Totals in an order file may differ by this from those of its boxes [kg, m]."""
PALLET_TOLERANCE = 0.001
"""An order's pallet may differ from the cell's by this [m]."""
CELL_FILE = "config/cells/palletizing.yaml"


def problems_of(order: Order, config: SupportConfig) -> list[str]:
    """Every reason why the order cannot be built as it stands; empty where it can."""
    if not order.boxes:
        return ["key 'boxes' is empty; allowed: one box or more"]
    named = [*_repeated(order), *_misdeclared(order)]
    placed = [*named, *_outside(order), *islice(_overlapping(order), MOST_OVERLAPS)]
    if placed:
        return placed  # whether boxes are carried is meaningless while their places are wrong
    carried = {**overloaded_boxes(order.placed), **unstable_boxes(order.placed, config)}
    return [f"box '{name}': {reason}" for name, reason in carried.items()]


def _repeated(order: Order) -> Iterator[str]:
    for name, n in Counter(item.id for item in order.boxes).items():
        if n > 1:
            yield f"box '{name}': key 'id' is given {n} times; allowed: once in an order"


def _misdeclared(order: Order) -> Iterator[str]:
    placed = order.placed
    sums: list[tuple[str, float | None, float, float]] = [
        ("total_boxes", order.total_boxes, len(placed), 0.0),
        ("total_weight", order.total_weight, sum(item.mass for item in placed), ROUNDING),
        ("stack_height", order.stack_height, max(float(item.upper[2]) for item in placed), ROUNDING),
    ]
    for key, given, actual, tolerance in sums:
        if given is not None and abs(given - actual) > tolerance:
            yield f"key '{key}' is {given:g}; its boxes give {actual:g}"
    for place, item in enumerate(order.boxes, start=1):
        yield from _misdeclared_box(place, item)


def _misdeclared_box(place: int, item: OrderBox) -> Iterator[str]:
    turn = item.turn
    if item.seq is not None and item.seq != place:
        yield f"box '{item.id}': key 'seq' is {item.seq}; it stands at place {place} of the order"
    if item.placed_dims is not None and not np.allclose(item.placed_dims, turn.extents, rtol=0, atol=TOUCH):
        yield (
            f"box '{item.id}': key 'placed_dims' is {list(item.placed_dims)}; dims, orient_id and "
            f"bundling_axis give {list(turn.extents)}"
        )
    if item.handling is not None and item.handling != turn.handling:
        yield (
            f"box '{item.id}': key 'handling' is '{item.handling}'; orient_id {item.orient_id} and "
            f"bundling_axis '{item.bundling_axis}' give '{turn.handling}'"
        )


def _outside(order: Order) -> Iterator[str]:
    deck = np.array([order.pallet.length, order.pallet.width])
    for item in order.placed:
        over = item.upper > np.array([*deck, TALLEST]) + TOUCH
        if np.any(item.lower < -TOUCH) or np.any(over):
            yield (
                f"box '{item.id}': key 'position' is {_shown(item.lower)}, it ends at {_shown(item.upper)}; "
                f"allowed: x 0 to {deck[0]:g}, y 0 to {deck[1]:g}, z 0 to {TALLEST:g}"
            )


def _overlapping(order: Order) -> Iterator[str]:
    boxes = order.placed
    lower, upper = np.array([item.lower for item in boxes]), np.array([item.upper for item in boxes])
    for i, first in enumerate(boxes):
        # all later boxes at once: an order of 1,000 boxes has half a million pairs
        clearance = np.maximum(lower[i] - upper[i + 1 :], lower[i + 1 :] - upper[i])
        for k in np.flatnonzero(np.all(clearance < -TOUCH, axis=1)):
            depth_mm = float(-clearance[k].max()) * 1e3
            second = boxes[i + 1 + int(k)]
            yield f"box '{second.id}': key 'position' makes it overlap box '{first.id}' by {depth_mm:.1f} mm"


def _shown(p: np.ndarray) -> str:
    return "(" + ", ".join(f"{value:.3f}" for value in p) + ")"


def misfits_of(order: Order, cell: PalletizingCell) -> list[str]:
    """Every reason why this cell cannot build the order; empty where it can."""
    return [*_wrong_pallet(order, cell), *(why for item in order.boxes for why in _not_held(item, cell))]


def _wrong_pallet(order: Order, cell: PalletizingCell) -> Iterator[str]:
    own = dict(zip(("length", "width"), cell.pallet.size, strict=True))
    for key, allowed in {**own, "deck_height": cell.pallet.deck_height}.items():
        given = getattr(order.pallet, key)
        if abs(given - allowed) > PALLET_TOLERANCE:
            yield f"key 'pallet.{key}' is {given:g}; allowed: {allowed:g}, the cell's ({CELL_FILE}: pallet)"


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
            reasons.setdefault(key, f"{text}; allowed: {passed.allowed:g} {unit} ({CELL_FILE}: grip.{key})")
        if grip.face < seal.side:
            text = f"its face is {grip.face:g} m wide where it is {grip.how}"
            reasons.setdefault("face", f"{text}; allowed: {seal.side:g} m ({CELL_FILE}: {seal.key})")
    return (f"box '{item.id}': {reason}" for reason in reasons.values())


@dataclass(frozen=True)
class PlannedGrip:
    """One of the ways in which a box is held by the gripper.

    Attributes:
        how: the grip in words.
        face: the shorter side of the face at the pad [m].
        load: upper bound of the load, whatever the direction of the acceleration.
    """

    how: str
    face: float
    load: GripLoad


def grips_of(item: OrderBox, acceleration: float) -> tuple[PlannedGrip, ...]:
    """The grips that a box's handling needs.

    Args:
        item: the box; its centre of mass is assumed in its middle.
        acceleration: largest acceleration at which it is carried, in any direction [m/s^2].
    """
    lying, shorter = item.dims[2], item.dims[1]
    from_above = PlannedGrip("held from above", shorter, _hanging(item.weight, lying, acceleration))
    if item.turn.handling is not Handling.TABLE:
        return (from_above,)
    length, width, height = item.turn.extents
    return (
        from_above,
        PlannedGrip("held at its side", shorter, _sideways(item.weight, lying, acceleration)),
        PlannedGrip("stood up", min(length, width), _hanging(item.weight, height, acceleration)),
    )


def _hanging(mass: float, depth: float, acceleration: float) -> GripLoad:
    """Load of a box that hangs under the pad, `depth` [m] along the pad's axis: its centre is depth / 2 away.

    Gravity and acceleration pull, acceleration shears, and the shear has the lever arm depth / 2.
    """
    shear = mass * acceleration
    return GripLoad(mass * (GRAVITY + acceleration), shear, 0.5 * depth * shear)


def _sideways(mass: float, depth: float, acceleration: float) -> GripLoad:
    """Load of a box held at its side, the pad's axis level: gravity and acceleration shear and bend."""
    shear = mass * (GRAVITY + acceleration)
    return GripLoad(mass * acceleration, shear, 0.5 * depth * shear)
