"""What the executor is doing."""

from __future__ import annotations

from enum import Enum


class Phase(Enum):
    """In the order in which an action goes through them."""

    IDLE = "IDLE"
    PERCEIVE = "PERCEIVE"
    PLAN = "PLAN"
    PICK = "PICK"
    PLACE = "PLACE"
    PUSH = "PUSH"
    RETREAT = "RETREAT"
    DONE = "DONE"
