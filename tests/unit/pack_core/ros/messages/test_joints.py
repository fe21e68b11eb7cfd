"""Setpoints survive the way through messages; other joints' never arrive."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np
import pytest
from trajectory_msgs.msg import JointTrajectory

from pack_core.errors import MessageError
from pack_core.joints import JointSample, Setpoints
from pack_core.ros.messages.joints import from_joint_state, from_trajectory, to_joint_state, to_trajectory

NAMES = ("shoulder", "elbow")
ROWS = np.arange(6.0).reshape(3, 2)
THIRD = ROWS + 20.0
FIELDS = (12.5, np.array([0.0, 0.1, 0.3]), ROWS, ROWS + 10.0)

Parse = Callable[[JointTrajectory, Sequence[str]], Any]
BOTH = [
    pytest.param(
        to_trajectory(Setpoints(*FIELDS, **{stated: THIRD}), NAMES),
        partial(from_trajectory, feed_forward=stated),
        id=stated,
    )
    for stated in ("a", "tau")
]
both = pytest.mark.parametrize(("message", "parse"), BOTH)


@both
def test_rows_come_back_as_they_were(message: JointTrajectory, parse: Parse) -> None:
    parsed = parse(message, NAMES)
    given = (parsed.time, parsed.offsets, parsed.q, parsed.v, parsed.fed_forward)
    for values, expected in zip(given, (*FIELDS, THIRD), strict=True):
        np.testing.assert_allclose(values, expected, atol=1e-9)


def test_the_torque_travels_as_effort_and_the_acceleration_as_acceleration() -> None:
    with_acceleration, with_torque = (param.values[0] for param in BOTH)
    assert list(with_torque.points[2].effort) == list(THIRD[2])
    assert not with_torque.points[2].accelerations
    assert list(with_acceleration.points[2].accelerations) == list(THIRD[2])
    assert not with_acceleration.points[2].effort


@both
@pytest.mark.parametrize("given", [["elbow", "elbow"], ["shoulder"], [], ["shoulder", "elbow", "wrist"]])
def test_other_joints_are_refused(message: JointTrajectory, parse: Parse, given: list[str]) -> None:
    other = JointTrajectory(header=message.header, joint_names=given, points=message.points)
    with pytest.raises(MessageError) as refused:
        parse(other, NAMES)
    assert str(given) in str(refused.value)
    assert "expected each of ['shoulder', 'elbow'] once" in str(refused.value)


@both
def test_joints_in_another_order_are_put_in_order(message: JointTrajectory, parse: Parse) -> None:
    turned = parse(message, NAMES[::-1])
    in_order = parse(message, NAMES)
    np.testing.assert_array_equal(turned.offsets, in_order.offsets)
    for column in ("q", "v", "fed_forward"):
        np.testing.assert_array_equal(getattr(turned, column), getattr(in_order, column)[:, ::-1])


@both
def test_a_message_without_points_is_refused(message: JointTrajectory, parse: Parse) -> None:
    with pytest.raises(MessageError, match="without points"):
        parse(JointTrajectory(joint_names=list(NAMES)), NAMES)


def test_points_of_different_length_are_refused() -> None:
    message = to_trajectory(Setpoints(*FIELDS, THIRD), NAMES)
    message.points[1].effort = [1.0]
    with pytest.raises(MessageError, match="different length in positions, velocities or effort"):
        from_trajectory(message, NAMES, "tau")


def test_joint_states_of_another_order_are_put_in_order() -> None:
    message = to_joint_state(JointSample(1.0, *ROWS), NAMES)
    assert from_joint_state(message, NAMES).tau.tolist() == ROWS[2].tolist()
    assert from_joint_state(message, NAMES[::-1]).tau.tolist() == ROWS[2].tolist()[::-1]
    with pytest.raises(MessageError, match="expected each of"):
        from_joint_state(message, ["shoulder", "wrist"])
