from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import pytest

from pack_core.joints import JointSample
from pack_core.motion.moves import Line, Path, PoseMove
from pack_core.motion.target import MotionState, MotionTarget
from pack_core.motion.world import Obstacle
from pack_core.rotations import Array, Pose
from pack_motion.arm.arm import MotionArm
from pack_motion.controller import RISES, MotionController, rising
from pack_motion.setpoint_stream import REST_SPEED, SetpointStream, StreamConfig
from pack_motion.tracking.config import motion_set
from unit.pack_motion.loop import pose

PERIOD, HORIZON = 0.004, 0.024


def sample(arm: MotionArm, time: float) -> JointSample:
    return JointSample(time, arm.home, np.zeros(6), np.zeros(6))


@pytest.fixture
def stream(arm: MotionArm) -> SetpointStream:
    controller = MotionController(arm, motion_set("shipped"), 1.0, arm.home)
    config = StreamConfig(period=PERIOD, horizon=HORIZON)
    return SetpointStream(controller, config, arm.limits.velocity)


def test_rows_reach_from_a_time_that_has_come_to_the_horizon(arm: MotionArm, stream: SetpointStream) -> None:
    for time in (1.0, 1.004, 1.011, 1.030):
        reference = stream.advance(sample(arm, time))
        assert time - PERIOD - 1e-9 <= reference.time <= time + 1e-9
        assert time + HORIZON - PERIOD - 1e-9 <= reference.end <= time + HORIZON + 1e-9
        np.testing.assert_allclose(np.diff(reference.offsets), PERIOD, atol=1e-9)


def test_a_row_once_given_out_never_changes(arm: MotionArm, stream: SetpointStream) -> None:
    stream.controller.command(MotionTarget(1, Path((PoseMove(pose(-2.5, 2.5, 1.1)),))))
    first, second = (stream.advance(sample(arm, time)) for time in (1.0, 1.008))
    shared = len(first.q) - 2
    np.testing.assert_array_equal(first.q[2:], second.q[:shared])
    assert np.abs(second.v[-1]).max() > 0.0


def test_only_time_that_goes_back_begins_anew(arm: MotionArm, stream: SetpointStream) -> None:
    stream.advance(sample(arm, 1.0))
    assert not stream.has_begun_anew(sample(arm, 0.99))
    assert stream.has_begun_anew(sample(arm, 0.5))


def test_an_arm_that_stands_goes_on_after_any_gap(arm: MotionArm, stream: SetpointStream) -> None:
    stream.advance(sample(arm, 1.0))
    reference = stream.advance(sample(arm, 9.0))
    assert reference is not None
    assert (reference.time, reference.end) == pytest.approx((9.0, 9.0 + HORIZON))
    assert (stream.interruption, stream.controller.is_held) == ("", False)


@dataclass
class Driver:
    """An arm that does what it is told, or brakes to a stand where setpoints have run out."""

    stream: SetpointStream
    time: float
    q: Array
    v: Array = field(default_factory=lambda: np.zeros(6))

    def tick(self, *, deaf: bool = False) -> None:
        """One period of the loop; what is published meanwhile is lost on an arm that is deaf."""
        reference = self.stream.advance(JointSample(self.time, self.q, self.v, np.zeros(6)))
        self.time += PERIOD
        if reference is None or deaf:
            self.v = 0.8 * self.v
            self.q = self.q + PERIOD * self.v
        else:
            self.q, self.v, _ = reference.at(self.time)

    def until(self, state: MotionState, *, deaf: bool = False) -> None:
        for _ in range(3000):
            if self.stream.controller.status().state is state:
                return
            self.tick(deaf=deaf)
        raise AssertionError(self.stream.controller.status())


GOAL, LAST = pose(-2.5, 2.5, 1.1), pose(-2.5, 2.5, 0.9)
MOVE = Path((PoseMove(GOAL, label="there"), Line(LAST, label="down", entry_speed=0.25)))


def test_a_status_names_the_segment_in_which_the_arm_was_measured(
    arm: MotionArm, stream: SetpointStream
) -> None:
    """Setpoints are ahead of it by the horizon, and brake for the next segment meanwhile."""
    driver, controller, slow = Driver(stream, 1.0, arm.home), stream.controller, 0.24
    far, near = pose(-2.5, 2.5, 1.5), pose(-2.5, 2.5, 1.0)
    lines = Line(near, 1.0, exit_speed=slow, label="fast"), Line(LAST, slow, label="slow")
    controller.command(MotionTarget(5, Path((PoseMove(far, label="there"), *lines))))
    speeds = []
    while controller.status().state is not MotionState.REACHED:
        driver.tick()
        if controller.status().label == "slow":
            speeds.append(np.linalg.norm(arm.chain.jacobian(driver.q)[:3] @ driver.v))
    assert max(speeds) < slow + 1e-3


@pytest.mark.parametrize("lost", ["setpoints", "measurements"])
@pytest.mark.parametrize("label", ["there", "down"])
def test_a_move_that_is_interrupted_is_held_until_the_arm_stands_and_then_goes_on(
    arm: MotionArm, stream: SetpointStream, lost: str, label: str
) -> None:
    driver, controller = Driver(stream, 1.0, arm.home), stream.controller
    controller.command(MotionTarget(5, MOVE))
    while controller.status().label != label or np.abs(driver.v).max() < 0.1:
        driver.tick()
    if lost == "measurements":
        driver.time += 0.5
    driver.until(MotionState.HELD, deaf=True)
    status = controller.status()
    assert (status.id, status.label) == (5, label)
    assert "holds the arm" in status.reason
    while stream.left is None:
        driver.tick()
    assert np.abs(driver.v).max() < REST_SPEED
    assert controller.status().state is MotionState.HELD
    assert controller.take(controller.prepare(stream.left)).is_accepted
    driver.until(MotionState.REACHED)
    status = controller.status()
    assert (status.id, status.label, status.reason) == (5, "down", "")
    assert np.linalg.norm(arm.chain.forward(driver.q).p - LAST.p) < 1e-4


def test_of_a_move_that_is_stopped_while_it_is_held_nothing_is_left(
    arm: MotionArm, stream: SetpointStream
) -> None:
    driver, controller = Driver(stream, 1.0, arm.home), stream.controller
    controller.command(MotionTarget(5, MOVE))
    while np.abs(driver.v).max() < 0.5:
        driver.tick()
    driver.until(MotionState.HELD, deaf=True)
    controller.stop()
    while controller.is_held:
        driver.tick()
    assert stream.left is None
    assert controller.status().state is MotionState.IDLE
    stood = driver.q.copy()
    for _ in range(100):
        driver.tick()
    np.testing.assert_allclose(driver.q, stood, atol=1e-6)


def test_a_move_that_is_abandoned_is_never_taken_up_again(arm: MotionArm, stream: SetpointStream) -> None:
    driver, controller = Driver(stream, 1.0, arm.home), stream.controller
    controller.command(MotionTarget(5, MOVE))
    while np.abs(driver.v).max() < 0.5:
        driver.tick()
    stream.abandon("the arm was stopped")
    assert controller.status().reason == "the arm was stopped; the driver holds the arm"
    driver.until(MotionState.IDLE)
    assert stream.left is None
    stood = driver.q.copy()
    stream.abandon("the arm was stopped again")  # a standing arm stands on
    for _ in range(100):
        driver.tick()
    np.testing.assert_allclose(driver.q, stood, atol=1e-6)


def test_an_arm_that_is_moved_by_force_is_followed_and_moves_nowhere_by_itself(
    arm: MotionArm, stream: SetpointStream
) -> None:
    driver = Driver(stream, 1.0, arm.home)
    driver.tick()
    driver.q = elsewhere = arm.home + 0.1
    for _ in range(200):
        driver.tick()
    np.testing.assert_allclose(driver.q, elsewhere, atol=1e-6)
    assert stream.controller.status().state is MotionState.IDLE


def interrupted(driver: Driver, move: Path, label: str) -> MotionTarget:
    """What is left of a move whose setpoints are lost at speed in a part of it; the wrist stops askew."""
    driver.stream.controller.command(MotionTarget(5, move))
    while driver.stream.controller.status().label != label or np.abs(driver.v).max() < 0.1:
        driver.tick()
    driver.until(MotionState.HELD, deaf=True)
    driver.q = driver.q + np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.01])
    while driver.stream.left is None:
        driver.tick()
    return driver.stream.left


def test_an_arm_that_came_to_rest_too_low_rises_before_it_goes_on(
    arm: MotionArm, stream: SetpointStream
) -> None:
    """A box as high as the tool stands in the straight way of the joints to a goal on the same level."""
    low = pose(-1.9, 2.75, 0.95)
    driver, controller = Driver(stream, 1.0, arm.home), stream.controller
    box = Obstacle("box", Pose(np.array([-2.2, 2.63, 0.85])), np.array([0.3, 0.3, 0.3]))
    target = MotionTarget(5, Path((PoseMove(LAST, label="there"),)), obstacles=(box,))
    ways = rising(target, low)
    assert [way.move.segments[0].X_WT.p[2] - low.p[2] for way in ways] == pytest.approx(RISES)
    assert all(way.move.segments[1:] == target.move.segments for way in ways)
    assert controller.command(MotionTarget(4, Path((PoseMove(low),)))).is_accepted
    driver.until(MotionState.REACHED)
    assert controller.prepare(target).plan is None
    assert any(controller.prepare(way).plan is not None for way in ways)


def test_a_rounded_corner_that_was_interrupted_is_no_reason_to_refuse(
    arm: MotionArm, stream: SetpointStream
) -> None:
    aside = pose(-2.4, 2.4, 0.9)
    move = Path(
        (PoseMove(GOAL), Line(LAST, entry_speed=0.25, exit_speed=0.2, blend=0.02, label="down"), Line(aside))
    )
    driver, controller = Driver(stream, 1.0, arm.home), stream.controller
    left = interrupted(driver, move, "down")
    assert controller.take(controller.prepare(left)).is_accepted
    driver.until(MotionState.REACHED)
    assert np.linalg.norm(arm.chain.forward(driver.q).p - aside.p) < 1e-4
