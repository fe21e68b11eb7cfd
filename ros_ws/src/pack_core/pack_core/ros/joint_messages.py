"""References for an arm's joints, to messages and back."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from builtin_interfaces.msg import Duration
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from pack_core import stamps
from pack_core.errors import MessageError
from pack_core.joint_reference import JointReference
from pack_core.ros.conversions import from_stamp, to_stamp


def to_trajectory(reference: JointReference, names: Sequence[str]) -> JointTrajectory:
    """A reference for the joints `names`."""
    message = JointTrajectory(joint_names=list(names))
    message.header.stamp = to_stamp(reference.time)
    for offset, q, v, a in zip(reference.offsets, reference.q, reference.v, reference.a, strict=True):
        sec, nanosec = stamps.split(float(offset))
        message.points.append(
            JointTrajectoryPoint(
                positions=q.tolist(), velocities=v.tolist(), accelerations=a.tolist(),
                time_from_start=Duration(sec=sec, nanosec=nanosec),
            )
        )  # fmt: skip
    return message


def from_trajectory(message: JointTrajectory, names: Sequence[str]) -> JointReference:
    """A reference as it came, for the joints `names`; the driver judges its size and limits.

    Raises:
        MessageError: other joints, no points, or rows of different length.
    """
    if list(message.joint_names) != list(names):
        raise MessageError(f"joint names are {list(message.joint_names)}; expected {list(names)}")
    rows = [
        (from_stamp(p.time_from_start), p.positions, p.velocities, p.accelerations) for p in message.points
    ]
    try:
        offsets, q, v, a = (np.array(column, dtype=float) for column in zip(*rows, strict=True))
    except ValueError as error:
        raise MessageError(f"a reference without points or with rows of different length: {error}") from error
    return JointReference(from_stamp(message.header.stamp), offsets, q, v, a)
