"""A jerk-limited stop of all joints within their limits."""

from __future__ import annotations

import numpy as np
import ruckig

from pack_core.robots.joint_limits import JointLimits
from pack_core.rotations import Array

RAMP = 0.1
"""Time in which full deceleration is reached [s]."""
SLACK = 1.001
"""The acceleration limit of a stop is at least this times the acceleration at its start, for rounding."""
Desired = tuple[Array, Array, Array]
"""Positions [rad], velocities [rad/s] and accelerations [rad/s^2] of the joints, each `(n,)`."""


class GentleStop:
    """Brings every joint to rest on its own, jerk-limited (ruckig).

    No joint gains speed in a stop. One that is speeding up stops doing so at once: with its acceleration
    ramped down it would gain speed for another `RAMP`. One that is about to turn round comes to rest instead.

    Args:
        time: when the stop begins [s].
        moving: position, velocity and acceleration of the joints at that time.
        limits: limits of the joints.
        deceleration: largest deceleration as a share of the acceleration limits.
    """

    def __init__(self, time: float, moving: Desired, limits: JointLimits, deceleration: float) -> None:
        q, v, a = moving
        a = _braking(v, a, deceleration * limits.acceleration / RAMP)
        self._start, self._limits = time, limits
        self._standing = q.copy()
        self._way = ruckig.Trajectory(len(limits))
        self._moves = bool(np.any(v) or np.any(a))
        if self._moves:
            request = ruckig.InputParameter(len(limits))
            request.control_interface = ruckig.ControlInterface.Velocity
            request.synchronization = ruckig.Synchronization.No
            request.current_position, request.current_velocity, request.current_acceleration = q, v, a
            request.target_velocity = request.target_acceleration = np.zeros(len(limits))
            most = np.maximum(deceleration * limits.acceleration, SLACK * np.abs(a))
            request.max_velocity, request.max_acceleration = limits.velocity, most
            request.max_jerk = most / RAMP
            ruckig.Ruckig(len(limits)).calculate(request, self._way)

    def at(self, time: float) -> Desired:
        """Desired state of the joints at `time` [s]; from the end of the stop on they stand still."""
        if not self._moves:
            rest = np.zeros(len(self._limits))
            return self._standing.copy(), rest, rest.copy()
        elapsed = min(time - self._start, self._way.duration)
        q, v, a = (np.array(row) for row in self._way.at_time(elapsed))
        return np.clip(q, self._limits.lower, self._limits.upper), v, a


def _braking(v: Array, a: Array, jerk: Array) -> Array:
    """The part of accelerations `a` that brakes joints of velocities `v` and turns none round, `(n,)`.

    Ramped down at `jerk`, an acceleration changes the velocity by another a^2 / (2 jerk).
    """
    most = np.sqrt(2.0 * jerk * np.abs(v))
    return np.where(v * a < 0.0, np.clip(a, -most, most), 0.0)
