"""The surface gripper's state as a message and back."""

from __future__ import annotations

from pack_interfaces.msg import GripperState

from pack_core.palletizing.grip import GripLoad, GripState
from pack_core.ros.conversions import finite, to_stamp


def to_gripper_state(time: float, state: GripState) -> GripperState:
    """A message of a gripper's state at `time` [s].

    While it is still closing, `is_closed` is false and the reason empty.
    """
    message = GripperState(
        is_closed=state.is_closed, object=state.held, coaxial_force=state.load.coaxial,
        shear_force=state.load.shear, moment=state.load.moment, release_reason=state.reason,
    )  # fmt: skip
    message.header.stamp = to_stamp(time)
    return message


def from_gripper_state(message: GripperState) -> GripState:
    """The gripper's state in a message, which does not hold the peak load: the load stands for it.

    Raises:
        MessageError: a load is not finite.
    """
    values = finite([message.coaxial_force, message.shear_force, message.moment], "gripper state: load")
    load = GripLoad(*(float(value) for value in values))
    is_closing = not message.is_closed and not message.release_reason
    return GripState(message.object, is_closing, load, load, message.release_reason)
