"""What the machine sees at a moment, and what it asks of the cell."""

from __future__ import annotations

from dataclasses import dataclass

from pack_core.motion.target import MotionStatus, MotionTarget
from pack_core.palletizing.box_detection import BoxDetection, ExpectedBox
from pack_core.palletizing.grip import GripState


@dataclass(frozen=True)
class PalletObservation:
    """What is known now.

    Attributes:
        time: [s].
        motion: newest status.
        grip: of the gripper.
        spawned: name of the box that came to table A last; empty before the first.
        detection: newest answer of the camera, if any.
    """

    time: float
    motion: MotionStatus
    grip: GripState
    spawned: str = ""
    detection: BoxDetection | None = None


@dataclass(frozen=True)
class SpawnBox:
    """Send a box to table A."""

    name: str
    dims: tuple[float, float, float]
    mass: float


@dataclass(frozen=True)
class DiscardBox:
    """Take a box out of the cell, wherever it stands."""

    name: str


@dataclass(frozen=True)
class TakePicture:
    """Take a picture of table A and find the box in it."""

    expected: ExpectedBox


@dataclass(frozen=True)
class PursueTarget:
    """Pursue a motion target."""

    target: MotionTarget


@dataclass(frozen=True)
class StopArm:
    """Brake to rest."""


@dataclass(frozen=True)
class CloseGripper:
    """Take hold of what is in front of the pad."""


@dataclass(frozen=True)
class OpenGripper:
    """Let go."""


Command = SpawnBox | DiscardBox | TakePicture | PursueTarget | StopArm | CloseGripper | OpenGripper
