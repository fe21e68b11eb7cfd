"""Collects the machine's observations from their topics."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from pack_interfaces.msg import BoxDetection as BoxDetectionMsg
from pack_interfaces.msg import GripperState
from pack_interfaces.msg import MotionStatus as MotionStatusMsg
from sensor_msgs.msg import PointCloud2

from pack_core.motion.target import MotionStatus
from pack_core.palletizing.boxes import BoxDetection
from pack_core.palletizing.cell import PALLET, REORIENTATION_TABLE
from pack_core.palletizing.grip import GripState
from pack_core.palletizing.ports import PalletObservation
from pack_core.palletizing.scanner import PlaceScan
from pack_core.ros.contracts import motion
from pack_core.ros.contracts import palletizing as contracts
from pack_core.ros.messages.conversions import from_stamp
from pack_core.ros.messages.motion import from_status
from pack_core.ros.messages.palletizing import from_cloud, from_detection, from_gripper_state
from pack_core.ros.node import CellNode
from pack_core.ros.stream import Stream, StreamReader

READ_PERIOD = 0.05
"""Longest time for which the reader waits for a status of the motion [s of wall clock]."""


class Observer:
    """Keeps the newest message of each topic; reads those of arm and gripper in a thread of its own.

    Args:
        node: the node that subscribes.
        on_motion: called in that thread after every status of the motion.

    Attributes:
        spawned: name of the box that arrived last.
        laid: name of what the operator laid on table A last.
    """

    def __init__(self, node: CellNode, on_motion: Callable[[], None]) -> None:
        self._node, self._on_motion = node, on_motion
        self._motion: MotionStatus | None = None
        self._grip: GripState | None = None
        self._detection: BoxDetection | None = None
        self._scans: dict[str, PlaceScan] = {}
        self.spawned = self.laid = ""
        node.listen(contracts.BOX_DETECTION, self._on_detection)
        node.listen(contracts.PALLET_SCAN, partial(self._on_scan, PALLET))
        node.listen(contracts.TABLE_SCAN, partial(self._on_scan, REORIENTATION_TABLE))
        self._statuses = Stream(node, motion.MOTION_STATUS)
        self._grips = Stream(node, contracts.GRIPPER_STATE)
        self._reader = StreamReader(node, (self._statuses,), self._read, READ_PERIOD)

    def end(self) -> None:
        """Read no more."""
        self._reader.end()

    @property
    def newest(self) -> PalletObservation | None:
        """The present observation; None before the first messages of motion and gripper.

        Its time is the node's clock; the motion's status has the time of the measurement, which is earlier.
        """
        if self._motion is None or self._grip is None:
            return None
        detection, time = self._detection, from_stamp(self._node.get_clock().now().to_msg())
        if detection is not None and detection.time > time:
            detection = None  # the simulator has begun anew since
        scans = tuple(scan for scan in list(self._scans.values()) if scan.time <= time)
        return PalletObservation(time, self._motion, self._grip, self.spawned, detection, scans, self.laid)

    def _read(self) -> None:
        for grip in self._grips.take_all():
            self._node.guard(contracts.GRIPPER_STATE, self._on_gripper, grip)
        for status in self._statuses.take_all():
            self._node.guard(motion.MOTION_STATUS, self._on_motion_status, status)

    def _on_motion_status(self, message: MotionStatusMsg) -> None:
        self._motion = from_status(message)
        self._on_motion()

    def _on_gripper(self, message: GripperState) -> None:
        self._grip = from_gripper_state(message)

    def _on_scan(self, place: str, message: PointCloud2) -> None:
        self._scans[place] = from_cloud(message, place)

    def _on_detection(self, message: BoxDetectionMsg) -> None:
        self._detection = from_detection(message)
