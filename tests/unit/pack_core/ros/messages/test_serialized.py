"""What is written straight in its serialised form is what rclpy makes of the same message."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from geometry_msgs.msg import WrenchStamped
from rclpy.serialization import deserialize_message, serialize_message
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState

from pack_core.errors import MessageError
from pack_core.joints import JointSample
from pack_core.ros.messages import serialized
from pack_core.ros.messages.conversions import to_stamp, to_vector
from pack_core.ros.messages.joints import from_joint_state, to_joint_state
from pack_core.ros.messages.scene import to_scene
from pack_core.ros.messages.serialized import (
    ClockWriter,
    JointStateReader,
    JointStateWriter,
    SceneWriter,
    WrenchReader,
    WrenchWriter,
)
from pack_core.rotations import Pose, from_rpy
from pack_core.states import ObjectState, SceneState, Source

TIMES = (0.0, 12.345678901, 4000.004)


def assert_is(data: bytes, message: Any) -> None:
    """The bytes read as the message, and are as many as its own; what lies between fields is arbitrary."""
    assert deserialize_message(data, type(message)) == message
    assert len(data) == len(serialize_message(message))


def test_ticks_of_the_clock() -> None:
    writer = ClockWriter()
    for time in TIMES:
        assert_is(writer.write(time), Clock(clock=to_stamp(time)))


def test_joint_states_of_arms_with_any_number_of_joints_and_any_names() -> None:
    rng = np.random.default_rng(0)
    for n in range(1, 9):
        names = [f"{'joint'[: 1 + k % 5]}{k}" for k in range(n)]
        writer = JointStateWriter(names)
        for time in TIMES:
            sample = JointSample(time, *rng.normal(size=(3, n)))
            assert_is(writer.write(sample), to_joint_state(sample, names))


def test_joint_states_are_read_in_the_order_asked_for() -> None:
    rng = np.random.default_rng(0)
    for n in range(1, 9):
        sent = [f"{'joint'[: 1 + k % 5]}{k}" for k in range(n)]
        asked = list(rng.permutation(sent))
        writer, reader = JointStateWriter(sent), JointStateReader(asked)
        for time in TIMES:
            sample = JointSample(time, *rng.normal(size=(3, n)))
            expected = from_joint_state(to_joint_state(sample, sent), asked)
            found = reader.read(writer.write(sample))
            assert found.time == expected.time
            for one, other in zip(
                (found.q, found.v, found.tau), (expected.q, expected.v, expected.tau), strict=True
            ):
                np.testing.assert_array_equal(one, other)


def test_what_looks_like_the_last_joint_state_is_not_taken_apart_field_by_field(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    reader, writer = JointStateReader(["b", "a"]), JointStateWriter(["a", "b"])
    reader.read(writer.write(JointSample(0.0, *np.zeros((3, 2)))))
    monkeypatch.delattr(serialized, "deserialize_message")
    found = reader.read(writer.write(JointSample(2.0, *np.arange(6.0).reshape(3, 2))))
    assert (found.time, found.tau.tolist()) == (2.0, [5.0, 4.0])


def test_a_reader_follows_a_sender_that_changes_the_order_of_its_joints() -> None:
    reader = JointStateReader(["b", "a"])
    for sent in (["a", "b"], ["a", "b"], ["b", "a"], ["a", "b"]):
        sample = JointSample(1.0, *np.arange(6.0).reshape(3, 2))
        found = reader.read(serialize_message(to_joint_state(sample, sent)))
        assert found.q.tolist() == ([1.0, 0.0] if sent == ["a", "b"] else [0.0, 1.0])


@pytest.mark.parametrize("names", [["a", "c"], ["a"], ["a", "b", "c"]])
def test_other_joints_are_refused_whatever_came_before(names: list[str]) -> None:
    reader = JointStateReader(["a", "b"])
    reader.read(JointStateWriter(["a", "b"]).write(JointSample(0.0, *np.zeros((3, 2)))))
    with pytest.raises(MessageError, match="joint names"):
        reader.read(JointStateWriter(names).write(JointSample(0.0, *np.zeros((3, len(names))))))


def test_joint_states_that_are_not_finite_or_not_whole_are_refused() -> None:
    reader, writer = JointStateReader(["a", "b"]), JointStateWriter(["a", "b"])
    reader.read(writer.write(JointSample(0.0, *np.zeros((3, 2)))))
    with pytest.raises(MessageError, match="joint velocity is not finite"):
        reader.read(writer.write(JointSample(0.0, np.zeros(2), np.array([np.nan, 0.0]), np.zeros(2))))
    with pytest.raises(MessageError, match="0 joint efforts"):
        reader.read(serialize_message(JointState(name=["a", "b"], position=[0.0, 0.0], velocity=[0.0, 0.0])))


def test_forces_are_read_in_any_frame_and_refused_where_they_are_not_finite() -> None:
    reader, rng = WrenchReader(), np.random.default_rng(0)
    for frame in ("", "tip", "tip", "a_longer_name", "tip"):
        writer = WrenchWriter(frame)
        for time in TIMES:
            force, torque = rng.normal(size=(2, 3))
            np.testing.assert_array_equal(reader.read(writer.write(time, force, torque)), force)
            message = WrenchStamped()
            message.header.frame_id, message.wrench.force = frame, to_vector(force)
            np.testing.assert_array_equal(reader.read(serialize_message(message)), force)
    for _ in range(2):
        with pytest.raises(MessageError, match="force is not finite"):
            reader.read(WrenchWriter("tip").write(1.0, np.array([0.0, np.nan, 0.0]), np.zeros(3)))


def test_wrenches_in_any_frame() -> None:
    rng = np.random.default_rng(0)
    for frame in ("", "tip", "tool0", "a_longer_name"):
        writer = WrenchWriter(frame)
        for time in TIMES:
            force, torque = rng.normal(size=(2, 3))
            message = WrenchStamped()
            message.header.stamp, message.header.frame_id = to_stamp(time), frame
            message.wrench.force, message.wrench.torque = to_vector(force), to_vector(torque)
            assert_is(writer.write(time, force, torque), message)


def test_scenes_whose_objects_come_and_go() -> None:
    rng = np.random.default_rng(0)

    def item(source: Source) -> ObjectState:
        X_WO = Pose(rng.normal(size=3), from_rpy(rng.normal(size=3)))
        return ObjectState(X_WO, *rng.normal(size=(2, 3)), source, float(rng.uniform()))

    writer = SceneWriter()
    for names in ((), ("can",), ("can", "a box"), ("tin", "a box"), ("tin", "a box", "tea_box_2")):
        for time, source in zip(TIMES, Source, strict=True):
            state = SceneState(time, {name: item(source) for name in names})
            assert_is(writer.write(state), to_scene(state))
