"""What two-finger grippers are told and what they say."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum


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
