"""How a driver stops an arm that gets no setpoints, and leads it back to those that come.

A stiff arm that is led along positions has to be stopped along positions, too, jerk-limited and within its
limits, and must not be torn to setpoints that go on elsewhere. A compliant arm that is led by torques may be
anywhere beside its setpoints: it is stopped from where it is measured, by a torque.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import ruckig

from pack_core.errors import MessageError
from pack_core.joints import Desired, FeedForward, Setpoints
from pack_core.robots.joint_properties import JointLimits
from pack_core.rotations import Array

RAMP = 0.1
"""Time in which a gentle stop reaches its full deceleration [s]."""
SLACK = 1.001
"""The acceleration limit of a stop is at least this times the acceleration at its start, for rounding."""
PERIOD = 0.004
"""Setpoints may be as far from a held arm as its velocity limits allow in this time [s], that of the cells'
setpoints."""
RATE = 15.0
"""Natural frequency of the critically damped approach to setpoints [1/s]: nearly there after 0.3 s."""
CATCH_UP, CREEP = 0.04, 0.004
"""On the way to setpoints a joint may be faster than they are by this share of their speed, or by this
[rad/s] if it is more. So a tool that is led at 0.24 m/s, as near contact, stays below 0.25 m/s; the approach
alone would take it to 0.27 m/s."""
SAME_POSITION, SAME_SPEED = 1e-6, 1e-4
"""Below these differences the arm follows the setpoints themselves [rad, rad/s]."""
BRAKE_TIME = 0.005
"""Time constant of a stop by torque [s]; the gains of Eq. 4 alone would take up to 0.4 s."""
LATE_BRAKE_TIME = 0.02
"""The same in free space where setpoints are late and nothing else is wrong [s].

Plans come late more often than there is anything to stop for. A stop from 0.3 m/s then pulls at the held
object with 8 N at most, where `BRAKE_TIME` pulls with 17 N, and takes 6 mm instead of 3 mm. In contact the
arm would press on meanwhile."""
SLOW_DOWN = 0.06
"""Time in which an arm led by torques comes to rest along setpoints that are overdue [s].

It takes half of that of the plan, and 9 mm at 0.3 m/s. The arm then needs no
stop at all for an iteration that came late by less, and in contact it neither jerks nor lets go.
"""
AT_REST = 0.01
"""Joint speed at which a stop by torque ends and the arm is held where it is [rad/s]."""


class TorqueBrake:
    """Stops an arm against its inertia, and holds it where it came to rest.

    Args:
        limits: limits of the joints.
        mass_matrix: gives the arm's mass matrix `(n, n)` [kg m^2] now.
        is_touching: tells whether the arm, or what it holds, touches something now.
    """

    feed_forward: FeedForward = "tau"
    slow_down = SLOW_DOWN

    def __init__(
        self, limits: JointLimits, mass_matrix: Callable[[], Array], is_touching: Callable[[], bool]
    ) -> None:
        self._limits, self._mass_matrix, self._is_touching = limits, mass_matrix, is_touching
        self._q_hold: Array | None = None
        self._was_touching: bool | None = None

    def hold(self, _: float, q: Array, v: Array, *, is_late: bool) -> Desired:
        """While the arm moves, the torque that stops it; then the place where it is held."""
        if self._q_hold is None and np.abs(v).max() > AT_REST:
            if self._was_touching is None:  # asked once: the stop's own pull at the object is no contact
                self._was_touching = self._is_touching()
            brake_time = LATE_BRAKE_TIME if is_late and not self._was_touching else BRAKE_TIME
            # desired are q and v themselves, so that only this torque acts: dv/dt = -v / brake_time
            return q, v, -(self._mass_matrix() @ v) / brake_time
        if self._q_hold is None:
            self._q_hold = np.clip(q, self._limits.lower, self._limits.upper)
        return self._q_hold, np.zeros(len(q)), np.zeros(len(q))

    def check(self, setpoints: Setpoints, time: float) -> None:
        """All may be followed: they begin where the arm was measured, and the gains are low."""

    def follow(self, setpoints: Setpoints, time: float) -> Desired:
        """The setpoints themselves."""
        self._q_hold = self._was_touching = None
        return setpoints.at(time)


class GentleBrake:
    """Stops an arm along a jerk-limited path, and has it join setpoints from nearby, within its limits.

    Args:
        limits: limits of the joints.
        deceleration: of the stop, as a share of the acceleration limits.
    """

    feed_forward: FeedForward = "a"
    slow_down = 0.0  # its stop is gentle itself, and keeps to limits that a slowed path could exceed

    def __init__(self, limits: JointLimits, deceleration: float) -> None:
        self._limits, self._deceleration = limits, deceleration
        self._stop: GentleStop | None = None
        self._is_apart = False
        self._last: tuple[float, Desired] | None = None

    def hold(self, time: float, q: Array, _: Array, *, is_late: bool) -> Desired:
        """The stop from what was desired last; before the first setpoints, where the arm is."""
        if self._stop is None:
            rest = np.zeros(len(self._limits))
            before, moving = self._last or (time, (q.copy(), rest, rest))
            self._stop, self._is_apart = GentleStop(before, moving, self._limits, self._deceleration), True
        desired = self._stop.at(time)
        self._last = time, desired
        return desired

    def check(self, setpoints: Setpoints, time: float) -> None:
        """Check that setpoints begin where the arm is held, or nearly there.

        Those that begin up to `PERIOD` later than `time` [s] are compared with where the held arm is by then.

        Raises:
            MessageError: they are farther away than the velocity limits allow in `PERIOD`.
        """
        if not self._is_apart or self._last is None:
            return
        before, (q, v, _) = self._last
        ahead = min(max(setpoints.time - before, 0.0), PERIOD)
        distance, most = setpoints.at(before + ahead)[0] - (q + ahead * v), PERIOD * self._limits.velocity
        joint = int(np.argmax(np.abs(distance) / most))
        if abs(distance[joint]) > most[joint]:
            raise MessageError(
                f"setpoints resumed, {self._limits.names[joint]} {distance[joint]:+.4f} rad from where the "
                f"arm was held without them; allowed: {most[joint]:.4f} rad, its velocity limit times "
                f"{1e3 * PERIOD:.0f} ms; plan again from the measured joints"
            )

    def follow(self, setpoints: Setpoints, time: float) -> Desired:
        """The setpoints, or the way to them after a stop."""
        self._stop = None
        desired = setpoints.at(time)
        if self._is_apart and self._last is not None:
            desired = self._approach(desired, time, *self._last)
        self._last = time, desired
        return desired

    def _approach(self, wanted: Desired, time: float, before: float, last: Desired) -> Desired:
        """What is desired at `time` after `last` at `before` [s], on the way to what is wanted.

        The difference x to the setpoints decays by a = -RATE^2 x - 2 RATE dx/dt, which is critically damped;
        acceleration, velocity and the speed of catching up are clipped.
        """
        h = time - before
        if h <= 0.0:
            return last
        (q_ref, v_ref, a_ref), (q, v, _) = wanted, last
        # Differences to the setpoints at `before`, extrapolated backwards from `time`.
        apart, slip = q - (q_ref - h * (v_ref - 0.5 * h * a_ref)), v - (v_ref - h * a_ref)
        if np.abs(apart).max() < SAME_POSITION and np.abs(slip).max() < SAME_SPEED:
            self._is_apart = False
            return wanted
        limits = self._limits
        a = _clip(a_ref - RATE * (RATE * apart + 2.0 * slip), limits.acceleration)
        v_new = _clip(v + h * a, limits.velocity)
        most = np.maximum(CATCH_UP * np.abs(v_ref), CREEP)
        v_new = np.where(apart < 0.0, np.minimum(v_new, v_ref + most), np.maximum(v_new, v_ref - most))
        v_new = v + h * _clip((v_new - v) / h, limits.acceleration)
        return q + 0.5 * h * (v + v_new), v_new, (v_new - v) / h


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
        """What is desired of the joints at `time` [s]; from the end of the stop on they stand still."""
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


def _clip(values: Array, limit: Array) -> Array:
    return np.asarray(np.clip(values, -limit, limit))
