"""Two-finger grippers: the room that they take on the table, what they are told and what they say."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum

from pydantic import Field, NonNegativeFloat, PositiveFloat

from pack_core.config import Config


class GripperFootprint(Config):
    """Fingers, clearances and limits of pushing; the values of a Robotiq 2F-85 by default [m].

    A finger is a wedge, so the deeper it reaches beside a block, the thicker it is there.
    """

    finger_width: PositiveFloat = Field(0.027, description="across the direction of closing [m]")
    finger_tip_thickness: PositiveFloat = Field(0.0057, description="along the direction of closing [m]")
    finger_taper: NonNegativeFloat = Field(0.52, description="thickness gained a metre above the tip")
    max_opening: PositiveFloat = Field(0.085, description="between the pads of the open gripper [m]")
    insertion: PositiveFloat = Field(0.020, description="how far the tips reach below a block's top [m]")
    opening_clearance: NonNegativeFloat = Field(
        0.004, description="between a pad and the block when opened [m]"
    )
    safety_margin: NonNegativeFloat = Field(0.002, description="around the fingers [m]")
    block_margin: NonNegativeFloat = Field(
        0.0005, description="around a block that is put down or pushed [m]"
    )
    push_gap: NonNegativeFloat = Field(
        0.010, description="between the pads of the gripper when it pushes [m]"
    )
    push_standoff: PositiveFloat = Field(0.005, description="from the finger to the face before a push [m]")
    min_push: PositiveFloat = Field(0.002, description="the shortest push [m]")
    max_push: PositiveFloat = Field(0.115, description="the longest push; longer ones drift sideways [m]")

    @property
    def finger_thickness(self) -> float:
        """Thickness of a finger at a block's top, which is its thickest part beside the block [m]."""
        return self.finger_tip_thickness + self.finger_taper * self.insertion

    @property
    def slab_thickness(self) -> float:
        """What must be free beside a face to grasp there, along the direction of closing [m]."""
        return self.finger_thickness + self.opening_clearance + self.safety_margin

    @property
    def slab_width(self) -> float:
        """What must be free beside a face to grasp there, across the direction of closing [m]."""
        return self.finger_width + 2 * self.safety_margin

    @property
    def push_width(self) -> float:
        """Of the pushing fingers, across the push [m]."""
        return self.push_gap + 2 * self.finger_thickness

    @property
    def push_tail(self) -> float:
        """From a block's rear face to the end of the room behind it that a push needs [m]."""
        return self.push_standoff + self.finger_width + self.safety_margin

    def grasp_opening(self, side: float) -> float:
        """Opening around a block before it is grasped and after it is released [m]."""
        return side + 2 * self.opening_clearance


class FingerStatus(IntEnum):
    """What the fingers are doing; the values of pack_interfaces/JawState."""

    MOVING = 0
    AT_OPENING = 1
    """They stand where they were told to."""
    HOLDING = 2
    """Something between them stopped them."""
    BLOCKED = 3
    """Something outside stopped them while they opened."""


@dataclass(frozen=True)
class FingerCommand:
    """Move the pads to a distance `opening` from each other [m], pressing with `force` [N] at most."""

    opening: float
    force: float


@dataclass(frozen=True)
class FingerState:
    """The fingers at `time` [s]: distance of the pads [m], force of each [N], positive when closing."""

    time: float
    opening: float
    force: float
    status: FingerStatus
