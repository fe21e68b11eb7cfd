"""Whole trajectories instead of setpoints, for an arm whose driver goes through the newest of them."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import pytest

from pack_core.joints import JointSample, Setpoints
from pack_core.motion.moves import Line, Path, PoseMove
from pack_core.motion.target import MotionState, MotionTarget
from pack_core.motion.world import Obstacle
from pack_core.rotations import Array, Pose
from pack_motion.arm.arm import MotionArm
from pack_motion.controller import MotionController
from pack_motion.setpoint_stream import SetpointStream, StreamConfig
from pack_motion.tracking.config import motion_set
from pack_motion.trajectory_output import LONGEST_GAP, Cancel, DriverClock, TrajectoryOutput
from unit.pack_motion.loop import pose

PERIOD, HORIZON = 0.004, 0.040
MOVE = Path(
    (
        PoseMove(pose(-2.5, 2.5, 1.1), label="there"),
        Line(pose(-2.5, 2.5, 0.9), label="down", entry_speed=0.25),
    )
)


@dataclass
class Driver:
    """An arm that is where its newest trajectory has it, a while after that was sent."""

    arm: MotionArm
    latency: float = 0.012
    time: float = 1.0
    sent: list[Setpoints] = field(default_factory=list)
    cancelled: int = 0
    is_stopped: bool = False
    q: list[Array] = field(default_factory=list)

    def __post_init__(self) -> None:
        controller = MotionController(self.arm, motion_set("shipped"), self.time, self.arm.home)
        limits = self.arm.limits
        config = StreamConfig(period=PERIOD, horizon=HORIZON)
        self.stream = SetpointStream(controller, config, limits.velocity, LONGEST_GAP)
        self.output = TrajectoryOutput(self.stream, HORIZON)
        self._under_way: list[tuple[float, Setpoints]] = []
        self._followed: Setpoints | None = None
        self._at, self._v = self.arm.home, np.zeros(self.arm.chain.n)

    @property
    def state(self) -> MotionState:
        return self.stream.controller.status().state

    def tick(self) -> None:
        sample = JointSample(self.time, self._at, self._v, np.zeros(len(self._at)))
        command = self.output.advance(sample, is_stopped=self.is_stopped)
        if isinstance(command, Cancel):
            self.cancelled += 1
            self._followed = None
            self._under_way.clear()
        elif command is not None:
            self.sent.append(command)
            self._under_way.append((self.time + self.latency, command))
        self.time += PERIOD
        while self._under_way and self._under_way[0][0] <= self.time:
            self._followed = self._under_way.pop(0)[1]
        if self._followed is None:
            self._v = np.zeros(len(self._at))
        else:
            self._at, self._v, _ = self._followed.at(self.time)
        self.q.append(self._at)

    def until(self, *states: MotionState) -> None:
        for _ in range(5000):
            if self.state in states:
                return
            self.tick()
        raise AssertionError(self.stream.controller.status())

    def until_fast(self, share: float = 0.3) -> None:
        while np.abs(self._v / self.arm.limits.velocity).max() < share:
            self.tick()

    def command(self, move: Path = MOVE) -> None:
        assert self.stream.controller.command(MotionTarget(5, move)).is_accepted

    @property
    def accelerations(self) -> Array:
        """As shares of the limits, at most `(n,)`."""
        a = np.diff(np.array(self.q), n=2, axis=0) / PERIOD**2
        return np.asarray(np.abs(a).max(axis=0) / self.arm.limits.acceleration)


@pytest.fixture
def driver(arm: MotionArm) -> Driver:
    return Driver(arm)


def assert_is_whole(trajectory: Setpoints) -> None:
    """It ends at rest, and its times rise by what differs in whole nanoseconds."""
    assert np.diff(trajectory.offsets).min() > 1e-9
    for column in (trajectory.v, trajectory.a):
        np.testing.assert_array_equal(column[-1], 0.0)


def test_a_move_that_nothing_disturbs_is_one_trajectory_and_is_followed_as_planned(driver: Driver) -> None:
    driver.command()
    plan = driver.stream.controller.plan.trajectory
    driver.until(MotionState.REACHED)
    (sent,) = driver.sent
    assert_is_whole(sent)
    assert sent.end - sent.time == pytest.approx(plan.duration, abs=HORIZON + PERIOD)
    np.testing.assert_allclose(sent.q[-1], plan.end.q, atol=1e-5)
    # Both ends of a longer way count from where the move begins: the horizon beyond the first measurement.
    for time in np.linspace(0.0, plan.duration, 50):
        np.testing.assert_allclose(sent.at(1.0 + time)[0], plan.at(time)[0].q, atol=1e-4)
    assert driver.accelerations.max() < 1.01


def test_an_arm_that_stands_is_sent_nothing(driver: Driver) -> None:
    for _ in range(100):
        driver.tick()
    assert (driver.sent, driver.cancelled) == ([], 0)


@pytest.mark.parametrize("why", ["target", "silence"])
def test_a_stop_in_motion_replaces_the_rest_of_the_move_smoothly(driver: Driver, why: str) -> None:
    driver.command()
    driver.until_fast()
    if why == "target":
        driver.stream.controller.stop()
    else:
        driver.stream.bar("silent: sim")
    asked = driver.time
    driver.tick()
    first, stop = driver.sent
    assert_is_whole(stop)
    assert stop.end < first.end - 0.5
    shared = np.linspace(asked, asked + HORIZON - PERIOD, 10)
    for time in shared:  # what the driver may have followed already is the same in both
        np.testing.assert_allclose(stop.at(time)[0], first.at(time)[0], atol=1e-5)
    while driver.time < stop.end + 0.1:
        driver.tick()
    np.testing.assert_allclose(driver.q[-1], stop.q[-1], atol=1e-6)
    assert len(driver.sent) == 2
    assert driver.accelerations.max() < 1.01


def test_a_stopped_driver_is_told_once_to_give_up_and_nothing_more(driver: Driver) -> None:
    driver.command()
    driver.until_fast()
    driver.is_stopped = True
    driver.stream.abandon("the arm was stopped")
    for _ in range(100):
        driver.tick()
    driver.is_stopped = False
    stood = driver.q[-1]
    for _ in range(200):
        driver.tick()
    assert (len(driver.sent), driver.cancelled) == (1, 1)
    np.testing.assert_array_equal(driver.q[-1], stood)


def test_what_a_driver_gives_up_is_planned_anew_from_where_the_arm_rests(driver: Driver) -> None:
    driver.command()
    driver.until_fast()
    driver.stream.interrupt("the driver gave a trajectory up")
    driver.tick()
    assert (driver.state, driver.cancelled) == (MotionState.HELD, 1)
    while driver.stream.left is None:
        driver.tick()
    assert driver.stream.controller.command(driver.stream.left).is_accepted
    rested = driver.q[-1]
    driver.until(MotionState.REACHED)
    np.testing.assert_allclose(driver.sent[-1].q[0], rested, atol=1e-6)
    assert driver.stream.controller.status().position_error < 1e-3


def test_while_the_arm_gives_way_each_trajectory_ends_in_a_stop_and_the_last_in_the_goal(
    driver: Driver,
) -> None:
    """Something moves near the way, and goes away again."""
    driver.command()
    driver.until_fast(0.1)
    p = driver.arm.chain.forward(driver.stream.controller.plan.trajectory.end.q).p
    near = Obstacle(
        "visitor",
        Pose(p + np.array([0.0, 0.0, 1.0])),
        np.full(3, 0.2),
        np.array([0.0, 0.0, -0.5]),
        is_moving=True,
    )
    begun = driver.time
    while driver.time < begun + 1.0:
        driver.stream.controller.observe([near])
        driver.tick()
    driver.stream.controller.observe([])
    during = len(driver.sent)
    driver.until(MotionState.REACHED)
    assert during > 5
    assert np.diff([trajectory.time for trajectory in driver.sent]).min() >= 0.5 * HORIZON - 1e-9
    for trajectory in driver.sent:
        assert_is_whole(trajectory)
    np.testing.assert_allclose(driver.q[-1], driver.sent[0].q[-1], atol=1e-3)
    assert driver.accelerations.max() < 1.05


def test_a_hole_in_the_measurements_costs_a_driver_nothing_that_knows_the_whole_move(driver: Driver) -> None:
    driver.command()
    driver.until_fast()
    followed = driver.sent[-1]
    for _ in range(100):  # 0.4 s, of which nothing is heard
        driver.time += PERIOD
    driver._at, driver._v, _ = followed.at(driver.time)
    driver.until(MotionState.REACHED, MotionState.HELD)
    assert (driver.state, len(driver.sent)) == (MotionState.REACHED, 1)


def test_trajectory_time_is_the_integral_of_the_scaling() -> None:
    clock = DriverClock()
    assert clock.at(3.0) == 3.0
    clock.see(3.0, 1.0)
    clock.see(4.0, 0.5)
    assert clock.at(4.0) == 4.0
    assert clock.at(6.0) == 5.0
    clock.see(6.0, 0.0)
    clock.see(9.0, 1.0)
    assert clock.at(10.0) == 6.0
    # A trajectory at 6.0 now is one that would have begun 4 s later than planned.
    assert clock.stamp(6.0) == 10.0
