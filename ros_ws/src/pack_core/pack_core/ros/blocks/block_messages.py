"""Blocks as seen, gripper and tags, to messages and back."""

from __future__ import annotations

from collections.abc import Mapping

from pack_interfaces.msg import BlockSighting as BlockSightingMsg
from pack_interfaces.msg import JawState as JawStateMsg
from std_msgs.msg import String

from pack_core.blocks.block_sighting import BlockSighting
from pack_core.blocks.fingers import FingerState, FingerStatus
from pack_core.blocks.tags_text import parse_tags, tags_text
from pack_core.errors import MessageError
from pack_core.ros.blocks.rearrangement_messages import from_block_poses, to_block_poses
from pack_core.ros.conversions import WORLD, finite, from_stamp, to_stamp


def to_tags(tags: Mapping[str, int]) -> String:
    """The number of every block's tag."""
    return String(data=tags_text(tags))


def from_tags(message: String) -> dict[str, int]:
    """The number of every block's tag, by the block's id."""
    return parse_tags(message.data)


def to_sighting(sighting: BlockSighting) -> BlockSightingMsg:
    """What was seen in a picture."""
    message = BlockSightingMsg(
        blocks=to_block_poses(sighting.poses), missing=list(sighting.missing),
        doubled=list(sighting.doubled), unknown=list(sighting.unknown),
    )  # fmt: skip
    message.header.stamp, message.header.frame_id = to_stamp(sighting.time), WORLD
    return message


def from_sighting(message: BlockSightingMsg) -> BlockSighting:
    """What was seen in a picture."""
    poses = from_block_poses(message.blocks, "blocks seen")
    for name, pose in poses.items():
        finite(pose.row, f"pose of {name}")
    return BlockSighting(
        from_stamp(message.header.stamp), poses, tuple(message.missing), tuple(message.doubled),
        tuple(message.unknown),
    )  # fmt: skip


def to_finger_state(state: FingerState, command: int) -> JawStateMsg:
    """The gripper's state after so many commands."""
    message = JawStateMsg(opening=state.opening, force=state.force, status=int(state.status), command=command)
    message.header.stamp = to_stamp(state.time)
    return message


def from_finger_state(message: JawStateMsg) -> FingerState:
    """The gripper's state."""
    if message.status not in list(FingerStatus):
        raise MessageError(
            f"status of the gripper is {message.status}; allowed: {[int(s) for s in FingerStatus]}"
        )
    opening, force = finite([message.opening, message.force], "state of the gripper")
    return FingerState(from_stamp(message.header.stamp), opening, force, FingerStatus(message.status))
