"""Setpoints written and read in their serialised form are those that messages would have."""

from __future__ import annotations

import struct

import numpy as np
import pytest
from rclpy.serialization import deserialize_message, serialize_message
from rosbags.typesys import Stores, get_typestore
from trajectory_msgs.msg import JointTrajectory

from pack_core.errors import MessageError
from pack_core.joints import FeedForward, Setpoints
from pack_core.ros.messages import serialized, serialized_setpoints
from pack_core.ros.messages.joints import from_trajectory, to_trajectory
from pack_core.ros.messages.serialized import MARK
from pack_core.ros.messages.serialized_setpoints import TrajectoryReader, TrajectoryWriter

RNG = np.random.default_rng(0)
RECORDED = get_typestore(Stores.ROS2_JAZZY)
"""What recordings are read with."""
both = pytest.mark.parametrize("stated", ["a", "tau"])


def setpoints(rows: int, n: int, stated: FeedForward, time: float = 12.345) -> Setpoints:
    offsets = np.cumsum(RNG.uniform(0.001, 0.5, rows)) - 0.001
    q, v, x = RNG.normal(size=(3, rows, n))
    return Setpoints(time, offsets, q, v, **{stated: x})


def assert_same(one: Setpoints, other: Setpoints) -> None:
    assert one.time == other.time
    for name in ("offsets", "q", "v", "tau", "a"):
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name))


@both
@pytest.mark.parametrize("n", range(1, 9))
def test_what_is_written_is_the_message(n: int, stated: FeedForward) -> None:
    names = [f"{'joint'[: 1 + k % 5]}{k}" for k in range(n)]
    writer = TrajectoryWriter(names)
    for rows in (1, 2, 11, 2):
        given = setpoints(rows, n, stated)
        data = writer.write(given)
        assert deserialize_message(data, JointTrajectory) == to_trajectory(given, names)
        RECORDED.deserialize_cdr(data, "trajectory_msgs/msg/JointTrajectory")  # refuses bytes at the end


def test_what_the_memory_held_before_behind_the_last_number_does_not_matter(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    left = struct.pack("<d", MARK)
    monkeypatch.setattr(serialized, "serialize_message", lambda message: serialize_message(message) + left)
    given = setpoints(11, 2, "tau")
    data = TrajectoryWriter(["a", "b"]).write(given)
    assert deserialize_message(data, JointTrajectory) == to_trajectory(given, ["a", "b"])
    RECORDED.deserialize_cdr(data, "trajectory_msgs/msg/JointTrajectory")  # refuses bytes at the end


def test_a_writer_takes_torques_and_accelerations_by_turns() -> None:
    writer = TrajectoryWriter(["a", "b"])
    for stated in ("a", "tau", "a"):
        given = setpoints(3, 2, stated)
        assert deserialize_message(writer.write(given), JointTrajectory) == to_trajectory(given, ["a", "b"])


@both
@pytest.mark.parametrize("n", range(1, 9))
def test_what_is_read_is_what_the_message_says_to_the_last_bit(n: int, stated: FeedForward) -> None:
    sent = [f"{'joint'[: 1 + k % 5]}{k}" for k in range(n)]
    asked = list(RNG.permutation(sent))
    reader, writer = TrajectoryReader(asked, stated), TrajectoryWriter(sent)
    for rows in (1, 1, 11, 11, 2, 11, 11):
        given = setpoints(rows, n, stated)
        message = to_trajectory(given, sent)
        expected = from_trajectory(message, asked, stated)
        assert_same(reader.read(writer.write(given)), expected)
        assert_same(reader.read(serialize_message(message)), expected)


@both
def test_what_looks_like_the_last_message_is_not_taken_apart_field_by_field(
    stated: FeedForward, monkeypatch: pytest.MonkeyPatch
) -> None:
    reader, writer = TrajectoryReader(["b", "a"], stated), TrajectoryWriter(["a", "b"])
    reader.read(writer.write(setpoints(11, 2, stated)))
    monkeypatch.delattr(serialized_setpoints, "deserialize_message")
    given = setpoints(11, 2, stated, time=99.0)
    assert_same(reader.read(writer.write(given)), from_trajectory(to_trajectory(given, "ab"), "ba", stated))


@both
def test_columns_that_nobody_reads_do_not_matter(stated: FeedForward) -> None:
    reader = TrajectoryReader(["a", "b"], stated)
    message = to_trajectory(setpoints(4, 2, stated), ["a", "b"])
    unread = "effort" if stated == "a" else "accelerations"
    for given in ([], [1.0, 2.0], [1.0], []):
        for point in message.points:
            setattr(point, unread, given)
        data = serialize_message(message)
        for _ in range(2):
            assert_same(reader.read(data), from_trajectory(message, ["a", "b"], stated))


@both
@pytest.mark.parametrize("n", [0, 1, 3])
def test_columns_of_another_size_are_handed_on_for_the_driver_to_refuse(n: int, stated: FeedForward) -> None:
    reader, names = TrajectoryReader(["a", "b"], stated), ["a", "b"]
    reader.read(TrajectoryWriter(names).write(setpoints(3, 2, stated)))
    message = to_trajectory(setpoints(3, n, stated), names)
    for _ in range(2):
        assert_same(reader.read(serialize_message(message)), from_trajectory(message, names, stated))


@both
def test_what_a_message_would_be_refused_for_is_refused(stated: FeedForward) -> None:
    reader, names = TrajectoryReader(["a", "b"], stated), ["a", "b"]
    reader.read(TrajectoryWriter(names).write(setpoints(3, 2, stated)))
    with pytest.raises(MessageError, match="joint names"):
        reader.read(TrajectoryWriter(["a", "c"]).write(setpoints(3, 2, stated)))
    with pytest.raises(MessageError, match="without points"):
        reader.read(serialize_message(JointTrajectory(joint_names=names)))
    uneven = to_trajectory(setpoints(3, 2, stated), names)
    uneven.points[1].velocities = [0.0]
    uneven.points[2].velocities = [0.0, 0.0, 0.0]
    with pytest.raises(MessageError, match="different length"):
        reader.read(serialize_message(uneven))
