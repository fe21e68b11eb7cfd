"""What box vision is asked for, and what it answers."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum

from pack_core.rotations import Pose

Dims = tuple[float, float, float]


@dataclass(frozen=True)
class ExpectedBox:
    """The box that should be in the picture.

    Attributes:
        id: its name in the order.
        dims: d_x >= d_y >= d_z as it arrives, d_z upright [m].
        time: pictures from before are of no use [s].
    """

    id: str
    dims: Dims
    time: float


class DetectionStatus(IntEnum):
    """Outcome; the values of pack_interfaces/BoxDetection."""

    DETECTED = 1
    NOT_FOUND = 2
    WRONG_SIZE = 3
    DOUBTFUL = 4


@dataclass(frozen=True)
class BoxDetection:
    """One picture's answer.

    Attributes:
        time: when the picture was taken [s].
        box_id: the expected box.
        status: whether it was detected.
        reason: why not, in words; empty when it was.
        X_WB: the box, its origin in its middle, x along d_x; None unless detected.
        X_WT: the tool (z: approach) with its pad on the middle of the top face; None unless detected.
        size: of the top face as measured, along and across [m]; zeros when not found.
    """

    time: float
    box_id: str
    status: DetectionStatus
    reason: str
    X_WB: Pose | None
    X_WT: Pose | None
    size: tuple[float, float]
