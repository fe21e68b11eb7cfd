"""The newest of what arm, gripper and tag perception say."""

from __future__ import annotations

from collections.abc import Callable

from pack_interfaces.msg import BlockSighting as BlockSightingMsg
from pack_interfaces.msg import JawState as JawStateMsg
from pack_interfaces.msg import MotionStatus as MotionStatusMsg

from pack_core.blocks.block_sighting import BlockSighting
from pack_core.blocks.jaw import JawState
from pack_core.motion.target import MotionStatus
from pack_core.ros.blocks.block_messages import from_jaw_state, from_sighting
from pack_core.ros.cell_node import CellNode
from pack_core.ros.contracts import blocks as contracts
from pack_core.ros.contracts import motion
from pack_core.ros.conversions import from_stamp
from pack_core.ros.motion_messages import from_status


class CellState:
    """Listens.

    Args:
        node: that listens.
        on_motion: is called with every status of the motion.

    Attributes:
        jaw_commands: how many commands the gripper had taken.
    """

    def __init__(self, node: CellNode, on_motion: Callable[[], None]) -> None:
        self._node, self._on_motion = node, on_motion
        self.motion: MotionStatus | None = None
        self.jaw: JawState | None = None
        self.jaw_commands = 0
        self.sighting: BlockSighting | None = None
        node.listen(motion.MOTION_STATUS, self._hear_motion)
        node.listen(contracts.JAW_STATE, self._hear_jaw)
        node.listen(contracts.BLOCK_POSES, self._hear_sighting)

    @property
    def time(self) -> float:
        """On the clock [s]; the status of the motion is ahead of it, as setpoints are, and tells no time."""
        return from_stamp(self._node.get_clock().now().to_msg())

    def _hear_motion(self, message: MotionStatusMsg) -> None:
        self.motion = from_status(message)
        self._on_motion()

    def _hear_jaw(self, message: JawStateMsg) -> None:
        self.jaw, self.jaw_commands = from_jaw_state(message), message.command

    def _hear_sighting(self, message: BlockSightingMsg) -> None:
        self.sighting = from_sighting(message)
