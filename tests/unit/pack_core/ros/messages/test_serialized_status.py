"""A status that is written and read straight in its serialised form is what rclpy makes of it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from pack_interfaces.msg import MotionStatus as MotionStatusMsg
from rclpy.serialization import deserialize_message, serialize_message

from pack_core.errors import MessageError
from pack_core.motion.target import MotionState, MotionStatus
from pack_core.ros.messages import serialized_status
from pack_core.ros.messages.motion import from_status, to_status
from pack_core.ros.messages.serialized_status import MotionStatusReader, MotionStatusWriter
from pack_core.rotations import Pose, from_rpy

STATUS = MotionStatus(
    12.345678901, 3, MotionState.MOVING, 2, "TRANSIT", 0.7, 0.1, 0.2, 1e-4, 0, "",
    Pose(np.array([1.0, -2.0, 0.5]), from_rpy((0.1, -0.2, 3.0))),
)  # fmt: skip
MOVED = replace(
    STATUS, time=12.35, remaining=0.6, position_error=float("inf"), path_error=2e-4, reached_steps=2,
    X_WT=Pose(np.array([1.1, -2.0, 0.5]), from_rpy((0.1, -0.3, 3.0))),
)  # fmt: skip
OTHERS = [
    replace(MOVED, label=label, reason=reason, state=state, id=number, segment=-1)
    for number, (label, reason, state) in enumerate((
        ("", "", MotionState.IDLE), ("LIFT", "held up for 3.0 s: the tool", MotionState.STUCK),
        ("A", "x", MotionState.REFUSED), ("AB", "", MotionState.REACHED),
    ))
]  # fmt: skip


def assert_same(found: MotionStatus, expected: MotionStatus) -> None:
    np.testing.assert_array_equal(found.X_WT.p, expected.X_WT.p)
    np.testing.assert_array_equal(found.X_WT.q, expected.X_WT.q)
    assert replace(found, X_WT=expected.X_WT) == expected


def test_it_is_written_and_read_as_rclpy_does_whatever_came_before() -> None:
    writer, reader = MotionStatusWriter(), MotionStatusReader()
    for status in (STATUS, MOVED, *OTHERS, STATUS, *OTHERS):
        data = writer.write(status)
        assert deserialize_message(data, MotionStatusMsg) == to_status(status)
        assert len(data) == len(serialize_message(to_status(status)))
        expected = from_status(to_status(status))
        assert_same(reader.read(data), expected)
        assert_same(reader.read(serialize_message(to_status(status))), expected)


def test_one_with_the_words_of_the_last_is_not_taken_apart_field_by_field(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    writer, reader = MotionStatusWriter(), MotionStatusReader()
    reader.read(writer.write(STATUS))
    monkeypatch.delattr(serialized_status, "deserialize_message")
    assert_same(reader.read(writer.write(MOVED)), from_status(to_status(MOVED)))


@pytest.mark.parametrize("is_known", [False, True])
def test_one_whose_tool_is_nowhere_is_refused(is_known: bool) -> None:
    reader = MotionStatusReader()
    if is_known:
        reader.read(serialize_message(to_status(STATUS)))
    message = to_status(STATUS)
    message.tool.position.y = float("nan")
    with pytest.raises(MessageError, match="position is not finite"):
        reader.read(serialize_message(message))
    message = to_status(STATUS)
    message.tool.orientation.w = 5.0
    with pytest.raises(MessageError, match="no unit quaternion"):
        reader.read(serialize_message(message))
