"""What a calibration sees at one moment."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from pack_core.joints import JointSample
from pack_core.motion.target import MotionStatus
from pack_core.palletizing.board_sighting import BoardSighting
from pack_core.palletizing.box_detection import BoxDetection
from pack_core.palletizing.grip import GripState


@dataclass(frozen=True)
class CalibrationObservation:
    """What is known now.

    Attributes:
        time: present time [s].
        motion: newest status of the motion.
        grip: newest state of the gripper.
        joints: reads what the driver reports now; its torques have noise.
        laid: name of what the operator laid on table A last; empty before the first.
        sighting: newest sighting of the calibration board; None before the first.
        detection: newest detection of a box; None before the first.
    """

    time: float
    motion: MotionStatus
    grip: GripState
    joints: Callable[[], JointSample]
    laid: str = ""
    sighting: BoardSighting | None = None
    detection: BoxDetection | None = None
