"""Joint states and setpoints of an arm, to messages and back."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from builtin_interfaces.msg import Duration
from sensor_msgs.msg import JointState
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from pack_core import stamps
from pack_core.errors import MessageError
from pack_core.joints import FeedForward, JointSample, Setpoints
from pack_core.ros.messages.conversions import finite, from_stamp, to_stamp

FIELDS: dict[FeedForward, str] = {"a": "accelerations", "tau": "effort"}
"""Field of a trajectory's points for what setpoints feed forward."""


def to_trajectory(setpoints: Setpoints, names: Sequence[str]) -> JointTrajectory:
    """A message of setpoints for the joints `names`."""
    message = JointTrajectory(joint_names=list(names))
    message.header.stamp = to_stamp(setpoints.time)
    stated = FIELDS["a" if setpoints.tau is None else "tau"]
    for offset, q, v, x in zip(
        setpoints.offsets, setpoints.q, setpoints.v, setpoints.fed_forward, strict=True
    ):
        sec, nanosec = stamps.split(float(offset))
        columns = {"positions": q.tolist(), "velocities": v.tolist(), stated: x.tolist()}
        message.points.append(
            JointTrajectoryPoint(time_from_start=Duration(sec=sec, nanosec=nanosec), **columns)
        )
    return message


def from_trajectory(message: JointTrajectory, names: Sequence[str], feed_forward: FeedForward) -> Setpoints:
    """Setpoints with their columns in the order of `names`; the driver judges their size and limits.

    Args:
        message: the trajectory.
        names: of the arm's joints.
        feed_forward: which column is read besides positions and velocities; others are ignored.

    Raises:
        MessageError: other joints, no points, or rows of different length.
    """
    order, field = _order_of(message.joint_names, names), FIELDS[feed_forward]
    rows = [
        (from_stamp(p.time_from_start), p.positions, p.velocities, getattr(p, field)) for p in message.points
    ]
    try:
        offsets, *columns = (np.array(column, dtype=float) for column in zip(*rows, strict=True))
    except ValueError as error:
        raise MessageError(
            f"a trajectory without points, or points of different length in positions, velocities or "
            f"{field}: {error}"
        ) from error
    q, v, x = (column[:, order] if column.shape[1:] == (len(names),) else column for column in columns)
    return Setpoints(from_stamp(message.header.stamp), offsets, q, v, **{feed_forward: x})


def to_joint_state(sample: JointSample, names: Sequence[str]) -> JointState:
    """A message of an arm's measured joints, in the order of `names`."""
    message = JointState(
        name=list(names), position=sample.q.tolist(), velocity=sample.v.tolist(), effort=sample.tau.tolist()
    )
    message.header.stamp = to_stamp(sample.time)
    return message


def from_joint_state(message: JointState, names: Sequence[str]) -> JointSample:
    """The measured joints in a message, in the order of `names`; MessageError unless it has exactly these."""
    order = _order_of(message.name, names)
    columns = [finite(values, f"joint {what}")[order] for what, values in _joint_columns(message)]
    return JointSample(from_stamp(message.header.stamp), *columns)


def _joint_columns(message: JointState) -> list[tuple[str, object]]:
    columns = [("position", message.position), ("velocity", message.velocity), ("effort", message.effort)]
    for what, values in columns:
        if len(values) != len(message.name):
            raise MessageError(f"{len(values)} joint {what}s; expected {len(message.name)}")
    return columns


def _order_of(given: Sequence[str], names: Sequence[str]) -> list[int]:
    """Where each of `names` stands among the joints of a message, which may have any order."""
    if sorted(given) != sorted(names):
        raise MessageError(f"joint names are {list(given)}; expected each of {list(names)} once")
    return [list(given).index(name) for name in names]
