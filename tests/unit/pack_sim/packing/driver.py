"""The packing arm's driver without its physics: a follower of setpoints and the law of its torques."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from pack_core.joints import Desired, Setpoints
from pack_core.robots.arm_drive import ArmDrive
from pack_core.rotations import Array
from pack_sim.brakes import TorqueBrake
from pack_sim.packing.joint_controller import JointController
from pack_sim.setpoint_follower import SetpointFollower


class Driver:
    """Takes setpoints and gives torques, as `Simulator.step` does."""

    def __init__(self, robot: ArmDrive, watchdog: float, torque_step: float = np.inf) -> None:
        self._M: Callable[[], Array] = lambda: np.eye(7)
        brake = TorqueBrake(robot.arm.limits, lambda: self._M(), lambda: self._law.is_touching)
        self._follower = SetpointFollower(robot.arm.limits, watchdog, brake)
        self._law = JointController(robot, torque_step=torque_step)

    @property
    def is_holding(self) -> bool:
        return self._follower.is_holding

    def accept(self, setpoints: Setpoints, time: float) -> None:
        self._follower.accept(setpoints, time)

    def drop(self) -> None:
        self._follower.drop()

    def reference(self, time: float, q: Array, v: Array, M: Callable[[], Array]) -> Desired:
        self._M = M
        return self._follower.at(time, q, v)

    def torque(self, time: float, q: Array, v: Array, M: Callable[[], Array]) -> Array:
        desired = self.reference(time, q, v, M)
        return self._law.torque(q, v, desired, is_holding=self.is_holding)
