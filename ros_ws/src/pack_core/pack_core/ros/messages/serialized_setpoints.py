"""Setpoints, written and read straight in their serialised form (CDR); see `serialized`."""

from __future__ import annotations

import struct
from collections.abc import Sequence

import numpy as np
from rclpy.serialization import deserialize_message
from trajectory_msgs.msg import JointTrajectory

from pack_core import stamps
from pack_core.joints import FeedForward, Setpoints
from pack_core.ros.messages.conversions import stamp_in
from pack_core.ros.messages.joints import from_trajectory, to_trajectory
from pack_core.ros.messages.serialized import AFTER_STAMP, MARK, Template

MOST_LENGTHS = 16
"""Numbers of rows for which a writer keeps a template; a sender has two or three."""


class TrajectoryWriter:
    """Writes the setpoints of an arm.

    Args:
        names: of its joints, in the order of the columns.
    """

    def __init__(self, names: Sequence[str]) -> None:
        self._names = names
        self._templates: dict[tuple[int, FeedForward], Template] = {}

    def write(self, setpoints: Setpoints) -> bytes:
        """A serialised trajectory_msgs/JointTrajectory."""
        n, stated = len(self._names), _stated(setpoints)
        template = self._template(len(setpoints.offsets), stated)
        columns = (setpoints.offsets, setpoints.q, setpoints.v, setpoints.fed_forward)
        between = (n,) if stated == "a" else (0, n)  # lengths of accelerations and efforts
        behind = (0,) if stated == "a" else ()
        rows = [
            (*q, n, *v, *between, *x, *behind, *stamps.split(offset))
            for offset, q, v, x in zip(*(column.tolist() for column in columns), strict=True)
        ]
        return template.filled(setpoints.time, rows)

    def _template(self, rows: int, stated: FeedForward) -> Template:
        if (rows, stated) not in self._templates:
            if len(self._templates) >= MOST_LENGTHS:
                self._templates.clear()
            n = len(self._names)
            q, zeros = np.full((rows, n), MARK), np.zeros((rows, n))
            marked = Setpoints(0.0, np.zeros(rows), q, zeros, **{stated: zeros})
            middle = "I4x" if stated == "a" else "II"
            end = "IiI" if stated == "a" else "iI"
            block = struct.Struct(f"<{n}dI4x{n}d{middle}{n}d{end}")
            self._templates[rows, stated] = Template(to_trajectory(marked, self._names), *rows * [block])
        return self._templates[rows, stated]


class TrajectoryReader:
    """Reads serialised setpoints, of which one message looks like the next but for its numbers.

    Args:
        names: of the joints, in the order in which the columns shall have them.
        feed_forward: which column is read besides positions and velocities.
    """

    def __init__(self, names: Sequence[str], feed_forward: FeedForward) -> None:
        self._names, self._feed_forward = names, feed_forward
        self._row = _row_type(len(names), feed_forward)
        self._known, self._rows, self._length = b"", 0, -1
        self._order: list[int] = []

    def read(self, data: bytes) -> Setpoints:
        """The setpoints in a serialised trajectory_msgs/JointTrajectory.

        Raises:
            MessageError: other joints, no points, or rows of different length.
        """
        return self._read_alike(data) or self._learn(data)

    def _read_alike(self, data: bytes) -> Setpoints | None:
        """The setpoints of a message with the joints and the number of rows of the last; None of another."""
        start, n = AFTER_STAMP + len(self._known), len(self._names)
        if len(data) != self._length or data[AFTER_STAMP:start] != self._known:
            return None
        # The last row ends with its duration, and not with the length of the next one's positions.
        padded = data + bytes(self._row.itemsize)
        if len(padded) < start + self._rows * self._row.itemsize:
            return None
        rows = np.frombuffer(padded, self._row, self._rows, start)
        lengths = (rows["n_v"], rows["n_x"], rows["n_next"][:-1])
        if rows["nothing"].any() or any((length != n).any() for length in lengths):
            return None
        offsets = (rows["sec"] * np.int64(stamps.NS_PER_S) + rows["nanosec"]) / stamps.NS_PER_S
        q, v, x = (rows[name][:, self._order] for name in ("q", "v", "x"))
        return Setpoints(stamp_in(data), offsets, q, v, **{self._feed_forward: x})

    def _learn(self, data: bytes) -> Setpoints:
        """Read a message field by field, and note how those look that have the same joints and rows."""
        message = deserialize_message(data, JointTrajectory)
        setpoints = from_trajectory(message, self._names, self._feed_forward)
        self._rows, self._length = len(message.points), len(data)
        first = message.points[0].positions.tobytes()
        self._known = bytes(data[AFTER_STAMP : data.find(first, AFTER_STAMP)])
        self._order = [list(message.joint_names).index(name) for name in self._names]
        again = self._read_alike(data)
        if again is None or not _are_same(again, setpoints):  # it has columns that others have not
            self._length = -1
        return setpoints


def _stated(setpoints: Setpoints) -> FeedForward:
    return "a" if setpoints.tau is None else "tau"


def _row_type(n: int, feed_forward: FeedForward) -> np.dtype[np.void]:
    """A row of a trajectory of n joints from its positions on, up to those of the next row.

    Each column stands behind its length. It begins at a multiple of eight bytes, so that there may be a gap.
    """
    q_and_v = [("q", "<f8", n), ("n_v", "<u4"), ("gap_v", "<u4"), ("v", "<f8", n)]
    duration = [("sec", "<i4"), ("nanosec", "<u4")]
    if feed_forward == "a":  # the efforts are empty
        x = [("n_x", "<u4"), ("gap_x", "<u4"), ("x", "<f8", n), ("nothing", "<u4")]
        return np.dtype([*q_and_v, *x, *duration, ("n_next", "<u4")])
    x = [("nothing", "<u4"), ("n_x", "<u4"), ("x", "<f8", n)]  # the accelerations are
    return np.dtype([*q_and_v, *x, *duration, ("n_next", "<u4"), ("gap_next", "<u4")])


def _are_same(one: Setpoints, other: Setpoints) -> bool:
    columns = ("offsets", "q", "v", "fed_forward")
    return one.time == other.time and all(
        np.array_equal(getattr(one, name), getattr(other, name), equal_nan=True) for name in columns
    )
