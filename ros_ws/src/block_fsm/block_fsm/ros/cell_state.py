"""The newest of what arm, gripper and tag perception say."""

from __future__ import annotations

from collections.abc import Callable

from pack_interfaces.msg import BlockSighting as BlockSightingMsg
from pack_interfaces.msg import JawState as JawStateMsg
from pack_interfaces.msg import MotionStatus as MotionStatusMsg

from pack_core.blocks.block_sighting import BlockSighting
from pack_core.blocks.gripper import FingerState
from pack_core.motion.target import MotionStatus
from pack_core.ros.contracts import blocks as contracts
from pack_core.ros.contracts import motion
from pack_core.ros.messages.blocks import from_finger_state, from_sighting
from pack_core.ros.messages.conversions import from_stamp
from pack_core.ros.messages.motion import from_status
from pack_core.ros.node import CellNode
from pack_core.ros.stream import Stream, StreamReader

READ_PERIOD = 0.05
"""Longest time for which the reader waits for a status of the motion [s of wall clock]."""


class CellState:
    """Subscribes to what arm, gripper and tag perception say, and keeps the newest.

    Arm and gripper are read in a thread of its own.

    Args:
        node: that listens.
        on_motion: is called in that thread with every status of the motion.

    Attributes:
        finger_commands: how many commands the gripper had taken.
    """

    def __init__(self, node: CellNode, on_motion: Callable[[], None]) -> None:
        self._node, self._on_motion = node, on_motion
        self.motion: MotionStatus | None = None
        self.fingers: FingerState | None = None
        self.finger_commands = 0
        self._sighting: BlockSighting | None = None
        node.listen(contracts.BLOCK_POSES, self._on_sighting)
        self._statuses, self._jaws = Stream(node, motion.MOTION_STATUS), Stream(node, contracts.JAW_STATE)
        self._reader = StreamReader(node, (self._statuses,), self._read, READ_PERIOD)

    def end(self) -> None:
        """Read no more."""
        self._reader.end()

    @property
    def time(self) -> float:
        """On the clock [s]; the status of the motion is ahead of it, as setpoints are, and tells no time."""
        return from_stamp(self._node.get_clock().now().to_msg())

    @property
    def sighting(self) -> BlockSighting | None:
        """The newest; none while its time is ahead, for the simulator has begun anew since."""
        sighting = self._sighting
        return sighting if sighting is not None and sighting.time <= self.time else None

    def _read(self) -> None:
        for jaws in self._jaws.take_all():
            self._node.guard(contracts.JAW_STATE, self._on_finger_state, jaws)
        for status in self._statuses.take_all():
            self._node.guard(motion.MOTION_STATUS, self._on_motion_status, status)

    def _on_motion_status(self, message: MotionStatusMsg) -> None:
        self.motion = from_status(message)
        self._on_motion()

    def _on_finger_state(self, message: JawStateMsg) -> None:
        self.fingers, self.finger_commands = from_finger_state(message), message.command

    def _on_sighting(self, message: BlockSightingMsg) -> None:
        self._sighting = from_sighting(message)
