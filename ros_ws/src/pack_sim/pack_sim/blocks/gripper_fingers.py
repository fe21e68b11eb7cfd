"""The gripper's own controller: fingers travel at a speed and press with no more than a force."""

from __future__ import annotations

import mujoco
import numpy as np

from pack_core.blocks.gripper import FingerCommand, FingerState, FingerStatus
from pack_core.errors import MessageError
from pack_core.robots.robotiq_2f85 import FINGER_JOINTS, MAX_FORCE, STROKE

PRESSING = 0.8
"""Share of the force at which fingers that stand still are taken to be stopped by something."""
STILL = 0.001
"""Speed of a finger below which it stands still [m/s]."""
SETTLED = 0.0003
"""A finger this near its target has reached it [m]."""
SETTLING_TIME = 0.03
"""A status is told once it has lasted this long, so that a bounce at a block's face is none [s]."""


class GripperFingers:
    """Drives both fingers of a model.

    Args:
        model: with the gripper's joints and actuators.
        speed: of the opening [m/s].
        force: that `command` may ask for and that is used at the start [N].
        opening: at the start [m].
    """

    def __init__(self, model: mujoco.MjModel, speed: float, force: float, opening: float) -> None:
        self._model = model
        joints = [model.joint(name) for name in FINGER_JOINTS]
        self._q = np.array([joint.qposadr[0] for joint in joints])
        self._v = np.array([joint.dofadr[0] for joint in joints])
        self._actuators = [model.actuator(name).id for name in FINGER_JOINTS]
        # Both fingers move, so each goes half the way that the opening does.
        self._step = 0.5 * speed * float(model.opt.timestep)
        self._target = self._setpoint = 0.5 * opening
        self._force = force
        self._status, self._candidate, self._since = FingerStatus.MOVING, FingerStatus.MOVING, 0.0
        self._limit()

    def command(self, command: FingerCommand) -> None:
        """Take a command, from the next step on.

        Raises:
            MessageError: an opening or a force that the gripper does not have.
        """
        if not 0.0 <= command.opening <= 2 * STROKE:
            raise MessageError(f"opening is {command.opening} m; allowed: 0 to {2 * STROKE} m")
        if not 0.0 < command.force <= MAX_FORCE:
            raise MessageError(f"force is {command.force} N; allowed: above 0, to {MAX_FORCE} N")
        self._target, self._force = 0.5 * command.opening, command.force
        self._status = self._candidate = FingerStatus.MOVING
        self._limit()

    def update(self, data: mujoco.MjData) -> None:
        """Set the controls for the next step, and judge the last one."""
        self._setpoint += min(max(self._target - self._setpoint, -self._step), self._step)
        data.ctrl[self._actuators] = self._setpoint
        found = self._judge(data)
        if found is not self._candidate:
            self._candidate, self._since = found, data.time
        if data.time - self._since >= SETTLING_TIME:
            self._status = found

    def state(self, data: mujoco.MjData) -> FingerState:
        """What the sensors of the gripper say."""
        position, force, _ = self._sense(data)
        return FingerState(float(data.time), 2.0 * position, force, self._status)

    def _judge(self, data: mujoco.MjData) -> FingerStatus:
        position, force, speed = self._sense(data)
        if speed > STILL or self._setpoint != self._target:
            return FingerStatus.MOVING
        if force > PRESSING * self._force:
            return FingerStatus.HOLDING
        if force < -PRESSING * self._force:
            return FingerStatus.BLOCKED
        return FingerStatus.AT_OPENING if abs(position - self._target) < SETTLED else FingerStatus.MOVING

    def _sense(self, data: mujoco.MjData) -> tuple[float, float, float]:
        """Of a finger: distance from the closing plane [m], force inwards [N], speed [m/s]."""
        # In plain numbers, as this is done in every step: of two, numpy takes ten times as long.
        q, v = data.qpos[self._q].tolist(), data.qvel[self._v].tolist()
        forces = data.actuator_force[self._actuators].tolist()
        return sum(q) / len(q), -sum(forces) / len(forces), max(map(abs, v))

    def _limit(self) -> None:
        self._model.actuator_forcerange[self._actuators] = (-self._force, self._force)
