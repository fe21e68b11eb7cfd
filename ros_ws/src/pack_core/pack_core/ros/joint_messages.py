"""Joint states, references and setpoints of an arm, to messages and back."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from builtin_interfaces.msg import Duration
from sensor_msgs.msg import JointState
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from pack_core import stamps
from pack_core.errors import MessageError
from pack_core.joints import JointReference, JointSample, Setpoints
from pack_core.ros.conversions import finite, from_stamp, to_stamp


def to_trajectory(reference: JointReference, names: Sequence[str]) -> JointTrajectory:
    """A message of a reference for the joints `names`."""
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


def to_joint_state(sample: JointSample, names: Sequence[str]) -> JointState:
    """A message of an arm's measured joints, in the order of `names`."""
    message = JointState(
        name=list(names), position=sample.q.tolist(), velocity=sample.v.tolist(), effort=sample.tau.tolist()
    )
    message.header.stamp = to_stamp(sample.time)
    return message


def from_joint_state(message: JointState, names: Sequence[str]) -> JointSample:
    """The measured joints in a message; MessageError unless they are exactly `names`, in this order."""
    if list(message.name) != list(names):
        raise MessageError(f"joint names are {list(message.name)}; expected {list(names)}")
    columns = [finite(values, f"joint {what}") for what, values in _joint_columns(message)]
    return JointSample(from_stamp(message.header.stamp), *columns)


def _joint_columns(message: JointState) -> list[tuple[str, object]]:
    columns = [("position", message.position), ("velocity", message.velocity), ("effort", message.effort)]
    for what, values in columns:
        if len(values) != len(message.name):
            raise MessageError(f"{len(values)} joint {what}s; expected {len(message.name)}")
    return columns


def to_setpoints(setpoints: Setpoints, names: Sequence[str]) -> JointTrajectory:
    """A message of setpoints over a horizon, for the joints `names`."""
    message = JointTrajectory(joint_names=list(names))
    message.header.stamp = to_stamp(setpoints.time)
    for offset, q, v, tau in zip(setpoints.offsets, setpoints.q, setpoints.v, setpoints.tau, strict=True):
        sec, nanosec = stamps.split(float(offset))
        message.points.append(
            JointTrajectoryPoint(
                positions=q.tolist(), velocities=v.tolist(), effort=tau.tolist(),
                time_from_start=Duration(sec=sec, nanosec=nanosec),
            )
        )  # fmt: skip
    return message


def from_setpoints(message: JointTrajectory) -> Setpoints:
    """The setpoints in a message as they came; the driver judges their size and limits.

    Raises:
        MessageError: no points, or rows of different length.
    """
    rows = [(from_stamp(p.time_from_start), p.positions, p.velocities, p.effort) for p in message.points]
    try:
        offsets, q, v, tau = (np.array(column, dtype=float) for column in zip(*rows, strict=True))
    except ValueError as error:
        raise MessageError(f"setpoints without points or with rows of different length: {error}") from error
    return Setpoints(from_stamp(message.header.stamp), offsets, q, v, tau)
