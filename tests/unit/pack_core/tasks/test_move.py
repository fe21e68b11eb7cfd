"""Where a move stands, from the statuses of the motion controller."""

from dataclasses import replace

import numpy as np
import pytest

from pack_core.motion.target import MotionState, MotionStatus
from pack_core.rotations import Pose
from pack_core.tasks.move import MoveFollower, follow
from pack_core.tasks.steps import TaskRun

X_WT = Pose(np.array([0.6, 0.0, 0.2]), np.array([0.0, 1.0, 0.0, 0.0]))
MOVING = MotionStatus(0.0, 7, MotionState.MOVING, 1, "down", 0.4, 0.1, 0.0, 0.0, 0, "", X_WT)
REFUSED = replace(MOVING, state=MotionState.REFUSED, reason="4 mm from 'b1'")
LAST = replace(MOVING, id=6, state=MotionState.REACHED)
"""Of an earlier task."""


@pytest.fixture
def move() -> MoveFollower:
    follower = MoveFollower(answer_time=10.0, longest=20.0)
    assert follower.begin(LAST, 0.0) == MOVING.id
    return follower


def test_a_target_is_numbered_on_from_what_was_heard_and_sent_before(move: MoveFollower) -> None:
    assert move.begin(LAST, 0.0) == 8
    assert move.begin(replace(LAST, id=30), 0.0) == 31
    assert MoveFollower(1.0).begin(None, 0.0) == 1


def test_the_status_of_an_earlier_target_counts_for_nothing(move: MoveFollower) -> None:
    assert move.stands(LAST, 1.0) is None
    assert move.stands(replace(REFUSED, id=6), 1.0) is None


def test_a_target_that_is_refused_at_once_is_refused(move: MoveFollower) -> None:
    assert move.stands(REFUSED, 1.0) is REFUSED


def test_a_move_that_was_interrupted_and_has_no_way_on_is_stuck(move: MoveFollower) -> None:
    held = replace(MOVING, state=MotionState.HELD, reason="no joint states")
    for status in (MOVING, held):
        assert move.stands(status, 1.0) is status
    answer = move.stands(REFUSED, 1.0)
    assert answer is not None
    assert (answer.state, answer.label) == (MotionState.STUCK, "down")
    assert answer.reason == "interrupted, and no way on: 4 mm from 'b1'"


@pytest.mark.parametrize(
    ("status", "time", "reason"), [(MOVING, 21.0, "takes too long"), (LAST, 11.0, "does not answer")]
)
def test_a_move_that_takes_too_long_is_stuck(
    move: MoveFollower, status: MotionStatus, time: float, reason: str
) -> None:
    answer = move.stands(status, time)
    assert answer is not None
    assert answer.state is MotionState.STUCK
    assert reason in answer.reason


def test_a_move_that_is_reached_late_is_reached(move: MoveFollower) -> None:
    reached = replace(MOVING, state=MotionState.REACHED)
    assert move.stands(reached, 21.0) is reached


def test_steps_follow_a_move_to_its_end(move: MoveFollower) -> None:
    heard = [None, LAST, MOVING, replace(MOVING, state=MotionState.REACHED)]
    run = TaskRun(follow(move, lambda: heard[0], lambda: 1.0))
    while len(heard) > 1:
        run.go_on()
        assert not run.is_over
        heard.pop(0)
    run.go_on()
    assert run.outcome is heard[0]
