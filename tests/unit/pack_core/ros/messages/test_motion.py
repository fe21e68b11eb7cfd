"""Motion targets and status survive the way through messages."""

from __future__ import annotations

from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np
import pytest

from pack_core.errors import MessageError
from pack_core.motion.moves import UP, JointMove, Line, Mode, Move, Path, PoseMove, Retreat, Transfer
from pack_core.motion.target import MotionState, MotionStatus, MotionTarget, ReachTolerance
from pack_core.motion.world import CarriedBox, Obstacle
from pack_core.ros.messages.motion import from_status, from_target, to_status, to_target
from pack_core.rotations import Pose, exp

X = Pose(np.array([0.1, 0.2, 0.3]), exp(np.array([0.1, 0.2, 0.3])))
LINES = (Line(X, 0.4, 2.0, 0.2, 0.1, 0.02, "approach"), Line(X, label="insert", mode=Mode.FAST))
PATH = Path((JointMove(np.arange(6.0), 0.5, 0.6, True, "a", Mode.SLOW), PoseMove(X, stop=True), *LINES))
TRANSFER = Transfer(LINES, Retreat(UP, (0.1, 0.9)), Retreat(UP, (0.06, 0.7), 0.3, 1.0, 0.2), 0.9, 0.8)


def assert_same(a: Any, b: Any) -> None:
    assert type(a) is type(b)
    if is_dataclass(a):
        for field in fields(a):
            assert_same(getattr(a, field.name), getattr(b, field.name))
    elif isinstance(a, tuple):
        assert len(a) == len(b)
        for one, other in zip(a, b, strict=True):
            assert_same(one, other)
    elif isinstance(a, np.ndarray | float):
        np.testing.assert_allclose(a, b, atol=1e-12)
    else:
        assert a == b


@pytest.mark.parametrize("move", [PATH, TRANSFER, Transfer(LINES, Retreat(UP, (0.1, 0.9)))])
def test_a_target_comes_back_as_it_was(move: Move) -> None:
    obstacles = (
        Obstacle("table", X, np.array([1.0, 2.0, 3.0])),
        Obstacle("cart", X, np.full(3, 0.1), np.array([0.1, 0.0, 0.0]), is_moving=True),
    )
    carried = CarriedBox(X, np.array([0.4, 0.3, 0.2]))
    contacts, tolerance = frozenset({"table"}), ReachTolerance(0.005, 1.0, 4)
    target = MotionTarget(7, move, carried, obstacles, contacts, tolerance, False, 0.05)
    assert_same(from_target(to_target(target, 1.5)), target)


def test_a_target_without_extras_comes_back_as_it_was() -> None:
    target = MotionTarget(1, PATH)
    assert_same(from_target(to_target(target, 0.0)), target)


def test_a_target_without_segments_is_an_empty_path() -> None:
    target = MotionTarget(3, Path(()))
    assert_same(from_target(to_target(target, 0.0)), target)


def test_a_status_comes_back_as_it_was() -> None:
    status = MotionStatus(2.5, 7, MotionState.STUCK, 2, "insert", 0.1, 0.2, 0.3, 0.4, 5, "held up", X)
    assert_same(from_status(to_status(status)), status)


def test_what_must_not_be_used_is_refused_in_words() -> None:
    cases = {
        "at least one": lambda m: m.segments.clear(),
        "mode of 'approach' is 'HASTY'": lambda m: setattr(m.segments[0], "mode", "HASTY"),
        "speeds of 'approach'": lambda m: setattr(m.segments[0], "speed", -1.0),
        "must all be lines": lambda m: setattr(m.segments[0], "kind", 1),
        "share of the joint limits of 'speed'": lambda m: setattr(m, "speed", 1.5),
        "rising lengths": lambda m: setattr(m.hover, "shortest", 5.0),
        "size": lambda m: setattr(m.carried_size, "x", -0.1),
        "not finite": lambda m: setattr(m.segments[0].pose.position, "x", float("nan")),
    }
    for words, spoil in cases.items():
        message = to_target(MotionTarget(1, TRANSFER, CarriedBox(X, np.full(3, 0.1))), 0.0)
        spoil(message)
        if words == "must all be lines":
            message.segments[0].speed = message.segments[0].acceleration = 1.0
        with pytest.raises(MessageError, match=words):
            from_target(message)
