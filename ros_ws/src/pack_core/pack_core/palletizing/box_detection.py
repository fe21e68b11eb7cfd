"""The request to box vision, and its answer."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum

from pack_core.rotations import Pose

Dims = tuple[float, float, float]


@dataclass(frozen=True)
class ExpectedBox:
    """The box that should be in the picture.

    Attributes:
        id: name of the box in the order.
        dims: extents d_x >= d_y >= d_z as it arrives, d_z upright [m].
        time: time from which on pictures are used [s].
    """

    id: str
    dims: Dims
    time: float


class DetectionStatus(IntEnum):
    """Outcome of a detection; the values are those of pack_interfaces/BoxDetection."""

    DETECTED = 1
    NOT_FOUND = 2
    WRONG_SIZE = 3
    DOUBTFUL = 4


@dataclass(frozen=True)
class BoxDetection:
    """What was detected in one picture.

    Attributes:
        time: when the picture was taken [s].
        box_id: name of the expected box.
        status: whether the box was detected.
        reason: why it was not, in words; empty when it was.
        X_WB: pose of the box, its origin in its middle, x along d_x; None unless detected.
        X_WT: pose of the tool (z: approach) with its pad on the middle of the top face; None unless detected.
        size: measured size of the top face, along and across [m]; zeros when not found.
    """

    time: float
    box_id: str
    status: DetectionStatus
    reason: str
    X_WB: Pose | None
    X_WT: Pose | None
    size: tuple[float, float]
