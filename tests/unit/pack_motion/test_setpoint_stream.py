from __future__ import annotations

import numpy as np
import pytest

from pack_core.motion.moves import Path, PoseMove
from pack_core.motion.target import MotionTarget
from pack_core.scene.state import JointSample
from pack_motion.arm.arm import Arm
from pack_motion.controller import MotionController
from pack_motion.setpoint_stream import SetpointStream
from pack_motion.tracking.config import motion_set
from unit.pack_motion.loop import pose

PERIOD, HORIZON = 0.004, 0.024


def sample(arm: Arm, time: float) -> JointSample:
    return JointSample(time, arm.home, np.zeros(6), np.zeros(6))


@pytest.fixture
def stream(arm: Arm) -> SetpointStream:
    controller = MotionController(arm, motion_set("shipped"), 1.0, arm.home)
    return SetpointStream(controller, PERIOD, HORIZON)


def test_rows_reach_from_a_time_that_has_come_to_the_horizon(arm: Arm, stream: SetpointStream) -> None:
    for time in (1.0, 1.004, 1.011, 1.030):
        reference = stream.advance(sample(arm, time))
        assert time - PERIOD - 1e-9 <= reference.time <= time + 1e-9
        assert time + HORIZON - PERIOD - 1e-9 <= reference.end <= time + HORIZON + 1e-9
        np.testing.assert_allclose(np.diff(reference.offsets), PERIOD, atol=1e-9)


def test_a_row_once_given_out_never_changes(arm: Arm, stream: SetpointStream) -> None:
    stream.controller.command(MotionTarget(1, Path((PoseMove(pose(-2.5, 2.5, 1.1)),))))
    first, second = (stream.advance(sample(arm, time)) for time in (1.0, 1.008))
    shared = len(first.q) - 2
    np.testing.assert_array_equal(first.q[2:], second.q[:shared])
    assert np.abs(second.v[-1]).max() > 0.0


def test_only_what_time_does_not_do_interrupts(arm: Arm, stream: SetpointStream) -> None:
    stream.advance(sample(arm, 1.0))
    assert not stream.is_interrupted(sample(arm, 1.02))
    assert stream.is_interrupted(sample(arm, 0.5))
    assert stream.is_interrupted(sample(arm, 2.0))
