"""How a box is gripped on its way to the pallet, and what its weight and acceleration ask of the gripper."""

from __future__ import annotations

from dataclasses import dataclass

from pack_core.palletizing.grip import GripLoad
from pack_core.palletizing.orders.handling import Handling
from pack_core.palletizing.orders.order import OrderBox

GRAVITY = 9.81
"""[m/s^2]"""


@dataclass(frozen=True)
class PlannedGrip:
    """One of the ways in which a box hangs in the hand.

    Attributes:
        how: in words.
        face: the shorter side of the face at the pad [m].
        load: at most, whatever the direction of the acceleration.
    """

    how: str
    face: float
    load: GripLoad


def grips_of(item: OrderBox, acceleration: float) -> tuple[PlannedGrip, ...]:
    """The grips that a box's handling takes.

    Args:
        item: the box; its mass is taken to be in its middle.
        acceleration: at which it is carried, in any direction [m/s^2].
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
    """The box, `depth` [m] along the pad's axis, hangs under the pad: gravity pulls, acceleration shears."""
    shear = mass * acceleration
    return GripLoad(mass * (GRAVITY + acceleration), shear, 0.5 * depth * shear)


def _sideways(mass: float, depth: float, acceleration: float) -> GripLoad:
    """The pad's axis is level: gravity and acceleration shear and bend."""
    shear = mass * (GRAVITY + acceleration)
    return GripLoad(mass * acceleration, shear, 0.5 * depth * shear)
