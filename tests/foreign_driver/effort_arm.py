"""The packing cell's arm behind a relay and a joint trajectory controller with effort interfaces."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from typing import Any

import numpy as np

from foreign_driver.joint_trajectory_controller import (
    JointTrajectoryController,
    Rejected,
    Tolerances,
    Waypoint,
)
from foreign_driver.trajectory_follower import TrajectoryFollower
from pack_core.joints import Desired, Setpoints
from pack_core.packing.topics import JOINT_RATE
from pack_core.robots.arm_drive import ArmDrive
from pack_core.rotations import Array
from pack_core.topics import steps_between
from pack_sim.packing.effort_relay import EffortRelay

LATENCY = 0.002
"""After which what the relay sends is with the controller [s]."""
COMMAND_TIMEOUT = 0.05
"""The controller's `cmd_timeout` of docs/cells/packing/driver_mappings.md [s]."""


class EffortLaw:
    """The controller's PID on effort interfaces: p and d of each joint, and the effort that is fed forward.

    It takes the place of the simulator's own law, and knows of no contact.
    """

    is_touching = False

    def __init__(self, drive: ArmDrive) -> None:
        gains, self._most = drive.applied, drive.arm.limits.effort
        self._p, self._d = np.array(gains.stiffness), np.array(gains.damping)

    def update_contact(
        self, time: float, force: Array, bending: float, v: Array, J: Callable[[], Array], *, is_holding: bool
    ) -> None:
        """Nothing is measured at the cup."""

    def torque(self, q: Array, v: Array, desired: Desired, *, is_holding: bool) -> Array:
        """Joint torques `(n,)` [N m] of the errors of position and velocity, within what motors give."""
        q_d, v_d, effort = desired
        torque = effort + self._p * (q_d - q) + self._d * (v_d - v)
        return np.asarray(np.clip(torque, -self._most, self._most))


def effort_controller(n: int) -> JointTrajectoryController:
    """A controller of n joints as docs/cells/packing/driver_mappings.md sets it up."""
    none = Tolerances(np.zeros(n), np.zeros(n))
    return JointTrajectoryController(
        n, none, drives_effort=True, interpolates_from_desired=True, may_end_moving=True,
        command_timeout=COMMAND_TIMEOUT,
    )  # fmt: skip


def to_waypoints(setpoints: Setpoints) -> tuple[Waypoint, ...]:
    """The points of a trajectory with efforts."""
    rows = zip(setpoints.offsets, setpoints.q, setpoints.v, setpoints.fed_forward, strict=True)
    return tuple(Waypoint(float(offset), q, v, effort=tau) for offset, q, v, tau in rows)


class RelayedFollower(TrajectoryFollower):
    """Has the controller drive the arm by what the relay makes of setpoints.

    Attributes:
        sent: trajectories.
        trouble: why the controller did not take some.
    """

    def __init__(self, controller: JointTrajectoryController, simulator: Any) -> None:
        super().__init__(controller, feed_forward="tau")
        self._jtc, self._simulator = controller, simulator
        config = simulator.config
        self._relay = EffortRelay(simulator.cell.robot.arm.limits, config.watchdog)
        self._every, self._cycles = steps_between(JOINT_RATE, config.timestep), 0
        self._under_way: deque[tuple[float, Setpoints]] = deque()
        self.sent = 0
        self.trouble: list[str] = []

    def at(self, time: float, q: Array, v: Array) -> Desired:
        """What the joints shall do now."""
        self._cycles += 1
        if self._cycles % self._every == 0:
            self._send(self._relay.advance(self._simulator.joints()), time)
        while self._under_way and self._under_way[0][0] <= time:
            self._deliver(self._under_way.popleft()[1])
        return super().at(time, q, v)

    def accept(self, setpoints: Setpoints, time: float) -> None:
        """Hand setpoints to the relay; raises MessageError where it refuses them."""
        self._send(self._relay.accept(setpoints, time), time)

    def _send(self, setpoints: Setpoints | None, time: float) -> None:
        if setpoints is not None:
            self._under_way.append((time + LATENCY, setpoints))

    def _deliver(self, setpoints: Setpoints) -> None:
        try:
            self._jtc.take(to_waypoints(setpoints), setpoints.time)
            self.sent += 1
        except Rejected as reason:
            self.trouble.append(str(reason))


def relay_driven(simulator: Any) -> RelayedFollower:
    """Have a controller drive the simulated packing cell's arm through a relay from now on."""
    joints = simulator.joints()
    controller = effort_controller(len(joints.q))
    controller.begin(joints.time, joints.q, joints.v)
    simulator.controller = EffortLaw(simulator.cell.robot)
    simulator.follower = arm = RelayedFollower(controller, simulator)
    return arm
