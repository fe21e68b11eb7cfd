"""What a move's answer is, from the statuses of the motion controller."""

from dataclasses import replace
from types import SimpleNamespace
from unittest.mock import Mock

import numpy as np
import pytest

from block_fsm.requests import MoveArm
from block_fsm.ros.pending_requests import PendingMove
from pack_core.motion.moves import JointMove, Path
from pack_core.motion.target import MotionState, MotionStatus
from pack_core.rotations import Pose

X_WT = Pose(np.array([0.6, 0.0, 0.2]), np.array([0.0, 1.0, 0.0, 0.0]))
MOVING = MotionStatus(0.0, 7, MotionState.MOVING, 1, "down", 0.4, 0.1, 0.0, 0.0, 0, "", X_WT)
REFUSED = replace(MOVING, state=MotionState.REFUSED, reason="4 mm from 'b1'")


def state(status: MotionStatus | None, time: float = 1.0) -> SimpleNamespace:
    return SimpleNamespace(motion=status, time=time)


@pytest.fixture
def move() -> PendingMove:
    request = MoveArm(Path((JointMove(np.zeros(6)),)), 0.05, ())
    return PendingMove(0.0, Mock(), request, 7, 20.0)


def test_a_target_that_is_refused_at_once_is_refused(move: PendingMove) -> None:
    assert move.poll(state(replace(REFUSED, id=6))) is None
    assert move.poll(state(REFUSED)) is REFUSED


def test_a_move_that_was_interrupted_and_has_no_way_on_is_stuck(move: PendingMove) -> None:
    held = replace(MOVING, state=MotionState.HELD, reason="no joint states")
    for status in (MOVING, held):
        assert move.poll(state(status)) is None
    answer = move.poll(state(REFUSED))
    assert isinstance(answer, MotionStatus)
    assert (answer.state, answer.label) == (MotionState.STUCK, "down")
    assert answer.reason == "interrupted, and no way on: 4 mm from 'b1'"


def test_a_move_that_takes_too_long_is_stuck(move: PendingMove) -> None:
    answer = move.poll(state(MOVING, time=21.0))
    assert isinstance(answer, MotionStatus)
    assert answer.state is MotionState.STUCK
