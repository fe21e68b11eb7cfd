"""How a box is gripped on its way to the pallet, and the loads of its weight and acceleration on the pad."""

from __future__ import annotations

from dataclasses import dataclass

from pack_core.palletizing.grip import GripLoad
from pack_core.palletizing.orders.handling import Handling
from pack_core.palletizing.orders.order import OrderBox

GRAVITY = 9.81
"""Acceleration of free fall [m/s^2]."""


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
