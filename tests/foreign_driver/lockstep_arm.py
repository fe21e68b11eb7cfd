"""The motion controller and a joint trajectory controller that it sends trajectories to, in lockstep."""

from __future__ import annotations

from collections import deque
from dataclasses import replace
from typing import Any

import numpy as np

from foreign_driver.joint_trajectory_controller import (
    JointTrajectoryController,
    Outcome,
    Rejected,
    Tolerances,
    Waypoint,
)
from foreign_driver.trajectory_follower import TrajectoryFollower
from pack_core.joints import JointSample, Setpoints
from pack_core.rotations import Array
from pack_lockstep.driven_arm import ReferenceDriver
from pack_motion.controller import MotionController
from pack_motion.setpoint_stream import SetpointStream, StreamConfig
from pack_motion.trajectory_output import LONGEST_GAP, Cancel, DriverClock, TrajectoryOutput

LATENCY = 3
"""Periods after which a trajectory is with the driver."""


class TrajectoryDrivenArm:
    """As `DrivenArm`, by trajectories, which reach the driver late.

    Attributes:
        sent: trajectories.
        trouble: why goals ended that were not replaced.
        sample: the joints as measured last; None before the first period.
    """

    def __init__(
        self, motion: MotionController, simulator: ReferenceDriver, driver: JointTrajectoryController,
        config: StreamConfig, velocity: Array,
    ) -> None:  # fmt: skip
        self._motion, self._simulator, self._driver = motion, simulator, driver
        self._stream = SetpointStream(motion, config, velocity, LONGEST_GAP)
        self._output = TrajectoryOutput(self._stream, config.horizon)
        self._period, self._clock = config.period, DriverClock()
        self._under_way: deque[tuple[int, Setpoints | Cancel]] = deque()
        tolerance = config.deviation * velocity
        self._tolerances = Tolerances(tolerance, tolerance, 1.0)
        self._ticks = self.sent = 0
        self.trouble: list[str] = []
        self.sample: JointSample | None = None

    @property
    def q_des(self) -> Array:
        """Joint positions `(n,)` [rad] that the driver asks for."""
        assert self._driver.state is not None
        return self._driver.state.reference[0]

    def advance(self) -> None:
        """A period: a measurement is answered, and the physics go on."""
        self.sample = sample = self._simulator.joints()
        command = self._output.advance(
            replace(sample, time=self._clock.at(sample.time)), is_stopped=self._driver.is_stopped
        )
        if command is not None:
            self.sent += 1
            self._under_way.append((self._ticks + LATENCY, command))
        while self._under_way and self._under_way[0][0] <= self._ticks:
            self._deliver(self._under_way.popleft()[1])
        for _ in range(round(self._period / self._simulator.config.timestep)):
            self._simulator.step()
        self._ticks += 1
        self._look_at_driver()
        if self._stream.left is not None:
            self._motion.command(self._stream.left)

    def _deliver(self, command: Setpoints | Cancel) -> None:
        if isinstance(command, Cancel):
            self._driver.cancel()
            return
        assert command.a is not None
        points = tuple(
            Waypoint(float(offset), q, v, a)
            for offset, q, v, a in zip(command.offsets, command.q, command.v, command.a, strict=True)
        )
        try:
            self._driver.follow(points, self._clock.stamp(command.time), self._tolerances)
        except Rejected as reason:
            self.trouble.append(str(reason))
            self._stream.abandon(f"the driver refused the trajectory: {reason}")

    def _look_at_driver(self) -> None:
        state = self._driver.state
        assert state is not None
        self._clock.see(state.time, state.scaling)
        for goal in self._driver.ended():
            if goal.outcome is Outcome.ABORTED and goal.error != "replaced by a new goal":
                self.trouble.append(goal.error)
                self._stream.interrupt(goal.error)


def trajectory_driven(
    motion: MotionController, simulator: Any, config: StreamConfig, velocity: Array
) -> TrajectoryDrivenArm:
    """The arm for a cell in lockstep, whose simulator a joint trajectory controller drives from now on."""
    none, joints = np.zeros(len(velocity)), simulator.joints()
    driver = JointTrajectoryController(len(velocity), Tolerances(none, none))
    driver.begin(joints.time, joints.q, joints.v)
    simulator.follower = TrajectoryFollower(driver)
    return TrajectoryDrivenArm(motion, simulator, driver, config, velocity)
