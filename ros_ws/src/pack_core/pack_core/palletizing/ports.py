"""What a task of the palletizing cell sees at one moment, and the commands that it gives to the cell.

Orders and calibrations share them; the node carries them by topics and services, the lockstep by calls.
"""

from __future__ import annotations

from dataclasses import dataclass

from pack_core.joints import JointSample
from pack_core.motion.target import MotionStatus, MotionTarget
from pack_core.palletizing.boxes import BoxBody, BoxDetection, ExpectedBox
from pack_core.palletizing.grip import GripState
from pack_core.palletizing.infeed import InfeedState
from pack_core.palletizing.orders.next_place import PlaceAnswer, PlaceQuestion
from pack_core.palletizing.scanner import PlaceScan
from pack_core.rotations import Pose


@dataclass(frozen=True)
class PalletObservation:
    """What is known now.

    Attributes:
        time: present time [s].
        motion: newest status of the motion.
        grip: newest state of the gripper.
        spawned: name of the box that arrived on table A last; empty before the first.
        detection: newest detection of a box; None before the first.
        scans: newest scan of each place that was scanned.
        laid: name of what the operator laid on table A last; empty before the first.
        samples: what was measured of the joints since the last observation, oldest first, with their torques.
        infeed: what the conveyor tells; None where there is none.
        place: newest answer about the place of a box; None before the first.
        taken: names of the places whose full pallet is being replaced by an empty one.
    """

    time: float
    motion: MotionStatus
    grip: GripState
    spawned: str = ""
    detection: BoxDetection | None = None
    scans: tuple[PlaceScan, ...] = ()
    laid: str = ""
    samples: tuple[JointSample, ...] = ()
    infeed: InfeedState | None = None
    place: PlaceAnswer | None = None
    taken: frozenset[str] = frozenset()


@dataclass(frozen=True)
class SpawnBox:
    """Send a box to table A."""

    name: str
    dims: tuple[float, float, float]
    mass: float


@dataclass(frozen=True)
class LayOnTable:
    """Have the operator lay something on table A.

    Attributes:
        body: what is laid there.
        X_NB: where it is asked for, on the table as it nominally stands.
    """

    body: BoxBody
    X_NB: Pose


@dataclass(frozen=True)
class DiscardBox:
    """Take a box out of the cell, wherever it stands; one that somebody has taken already is no fault."""

    name: str


@dataclass(frozen=True)
class TakePicture:
    """Take a picture of table A and find the box in it."""

    expected: ExpectedBox


@dataclass(frozen=True)
class ScanPlace:
    """Measure the heights of what stands at a place, one of `SCANNED`."""

    place: str


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


@dataclass(frozen=True)
class SendBox:
    """Have the conveyor bring the next box, now that the last one has left it."""


@dataclass(frozen=True)
class AskPlace:
    """Ask where a box goes."""

    question: PlaceQuestion


@dataclass(frozen=True)
class TakePallet:
    """Have a full pallet taken away and an empty one put in its place.

    Attributes:
        place: name of the pallet's place.
        boxes: names of those that stand on it.
    """

    place: str
    boxes: tuple[str, ...]


Command = (
    SpawnBox | LayOnTable | DiscardBox | TakePicture | ScanPlace | PursueTarget | StopArm | CloseGripper
    | OpenGripper | SendBox | AskPlace | TakePallet
)  # fmt: skip
