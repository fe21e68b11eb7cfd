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
from pack_core.ros.messages.conversions import finite, from_stamp, to_stamp
from pack_core.rotations import Array


def to_trajectory(reference: JointReference, names: Sequence[str]) -> JointTrajectory:
    """A message of a reference for the joints `names`."""
    columns = {"positions": reference.q, "velocities": reference.v, "accelerations": reference.a}
    return _to_points(reference.time, reference.offsets, names, columns)


def from_trajectory(message: JointTrajectory, names: Sequence[str]) -> JointReference:
    """A reference with its columns in the order of `names`; the driver judges its size and limits.

    Raises:
        MessageError: other joints, no points, or rows of different length.
    """
    return JointReference(*_from_points(message, names, "accelerations"))


def to_setpoints(setpoints: Setpoints, names: Sequence[str]) -> JointTrajectory:
    """A message of setpoints over a horizon, for the joints `names`."""
    columns = {"positions": setpoints.q, "velocities": setpoints.v, "effort": setpoints.tau}
    return _to_points(setpoints.time, setpoints.offsets, names, columns)


def from_setpoints(message: JointTrajectory, names: Sequence[str]) -> Setpoints:
    """Setpoints with their columns in the order of `names`; the driver judges their size and limits.

    Raises:
        MessageError: other joints, no points, or rows of different length.
    """
    return Setpoints(*_from_points(message, names, "effort"))


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


def _to_points(
    time: float, offsets: Array, names: Sequence[str], columns: dict[str, Array]
) -> JointTrajectory:
    """A trajectory from `time` [s]; `columns` has the rows `(T, n)` of each field of its points."""
    message = JointTrajectory(joint_names=list(names))
    message.header.stamp = to_stamp(time)
    for offset, *row in zip(offsets, *columns.values(), strict=True):
        sec, nanosec = stamps.split(float(offset))
        fields = {field: values.tolist() for field, values in zip(columns, row, strict=True)}
        message.points.append(
            JointTrajectoryPoint(time_from_start=Duration(sec=sec, nanosec=nanosec), **fields)
        )
    return message


def _from_points(
    message: JointTrajectory, names: Sequence[str], third: str
) -> tuple[float, Array, Array, Array, Array]:
    """Time and offsets of a trajectory [s], with its positions, velocities and the field `third`."""
    order = _order_of(message.joint_names, names)
    rows = [
        (from_stamp(p.time_from_start), p.positions, p.velocities, getattr(p, third)) for p in message.points
    ]
    try:
        offsets, q, v, x = (np.array(column, dtype=float) for column in zip(*rows, strict=True))
    except ValueError as error:
        raise MessageError(
            f"a trajectory without points, or points of different length in positions, velocities or "
            f"{third}: {error}"
        ) from error
    columns = [column[:, order] if column.shape[1:] == (len(names),) else column for column in (q, v, x)]
    return from_stamp(message.header.stamp), offsets, columns[0], columns[1], columns[2]


def _order_of(given: Sequence[str], names: Sequence[str]) -> list[int]:
    """Where each of `names` stands among the joints of a message, which may have any order."""
    if sorted(given) != sorted(names):
        raise MessageError(f"joint names are {list(given)}; expected each of {list(names)} once")
    return [list(given).index(name) for name in names]
