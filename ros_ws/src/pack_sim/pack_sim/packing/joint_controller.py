"""Low-level joint controller: interpolated setpoints, PD with feed-forward torque, watchdog, brake.

Eq. 4 of "Pack it in", with the signs of the errors turned so that it is stable:
`tau = tau_ff + Kp (q_d - q) + Kd (v_d - v)`. Gravity is compensated below this law.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from pack_core.errors import MessageError
from pack_core.joints import Setpoints
from pack_core.robots.arm_drive import ArmDrive
from pack_core.robots.joint_limits import JointLimits
from pack_core.rotations import Array
from pack_sim.packing.governor import ContactGovernor

SLACK = 1e-6
"""By how much a setpoint may exceed a limit, for rounding errors [rad, rad/s, N m]."""
LEAD = 1.0
"""How far ahead of the driver's clock setpoints may begin [s]. A plan begins tens of milliseconds ahead; one
that begins much later was stamped by another clock, and its time would never come."""
SAME_TIME = 1e-6
"""Times that differ by no more are equal but for rounding [s]."""
BRAKE_TIME = 0.005
"""Time constant of the stop before a hold [s]; the gains of Eq. 4 alone would take up to 0.4 s."""
SLIDING = 0.02
"""Speed from which most of the friction is compensated [rad/s]."""
AT_REST = 0.01
"""Joint speed at which braking ends and the arm is held where it is [rad/s]."""


class JointController:
    """Tracks the newest setpoints; without fresh ones it stops the arm and holds its position.

    Args:
        robot: the arm with its limits, and the gains.
        watchdog: age at which setpoints are stale [s].
        governor: limits velocities and torques in contact; None: nothing does.
        friction: friction of each joint, which is compensated in the direction it is driven in [N m].
        torque_step: largest change of a torque from one step to the next while setpoints are tracked [N m].
    """

    def __init__(
        self,
        robot: ArmDrive,
        watchdog: float,
        governor: ContactGovernor | None = None,
        friction: float = 0.0,
        torque_step: float = np.inf,
    ) -> None:
        self._limits = robot.arm.limits
        applied = robot.applied
        self._kp, self._kd = np.array(applied.stiffness), np.array(applied.damping)
        self._kp_hold, self._kd_hold = np.array(robot.stiffness), np.array(robot.damping)
        self._watchdog, self._governor, self._friction = watchdog, governor, friction
        self._torque_step, self._tau = torque_step, np.zeros(len(self._limits))
        self._jacobian: Array | None = None
        self._setpoints: Setpoints | None = None
        self._next: Setpoints | None = None
        self._received = -np.inf
        self._q_hold: Array | None = None
        self.is_holding = False
        """Whether the last torque braked or held the arm, for want of fresh setpoints."""

    def accept(self, setpoints: Setpoints, time: float) -> None:
        """Check and store setpoints that arrived at `time` [s].

        Those that come early wait for the time of their first row, which is where the arm will be by then,
        and the arm goes on with the ones before. They wait no longer than until others come.

        Raises:
            MessageError: wrong size, not finite, out of order, beyond a joint's limits, or of another clock.
        """
        _check(setpoints, self._limits)
        if setpoints.time > time + LEAD:
            raise MessageError(
                f"setpoints begin {setpoints.time - time:.3f} s ahead of the driver's time {time:.3f} s; "
                f"allowed: {LEAD:.3f} s. Their stamp must be of the clock that stamps the joint states"
            )
        if setpoints.time > time + SAME_TIME:
            self._setpoints, self._next = self._next or self._setpoints, setpoints
        else:
            self._setpoints, self._next = setpoints, None
        self._received = time

    def drop(self) -> None:
        """Discard the setpoints, as when their sender died: brake and hold from the next step on."""
        self._setpoints = self._next = None

    def update_contact(
        self, time: float, force: Array, bending: float, v: Array, J: Callable[[], Array]
    ) -> None:
        """Update the governor with what is measured at the cup.

        Args:
            time: now [s].
            force: external force on the held object `(3,)` [N], in the world frame.
            bending: bending moment on the cup [N m].
            v: joint velocities `(7,)` [rad/s].
            J: returns the cup's Jacobian `(6, 7)`, linear part first, in the world frame.
        """
        if self._governor is not None:
            is_contact = self._governor.update(time, force, bending, is_holding=self.is_holding)
            self._jacobian = J() if is_contact else None
            if self._jacobian is not None:
                self._governor.follow(self._jacobian[:3] @ v)

    def reference(
        self, time: float, q: Array, v: Array, M: Callable[[], Array]
    ) -> tuple[Array, Array, Array]:
        """Desired position, velocity and feed-forward torque at `time`, each `(7,)`; see `torque`."""
        if self._next is not None and time >= self._next.time - SAME_TIME:
            self._setpoints, self._next = self._next, None
        plan = self._setpoints
        if plan is not None and self._is_fresh(plan, time):
            self._q_hold, self.is_holding = None, False
            return plan.at(time)
        self.is_holding = True
        if self._q_hold is None and np.abs(v).max() > AT_REST:
            # desired are q and v themselves, so that only this torque acts: dv/dt = -v / BRAKE_TIME
            return q, v, -(M() @ v) / BRAKE_TIME
        if self._q_hold is None:
            self._q_hold = np.clip(q, self._limits.lower, self._limits.upper)
        return self._q_hold, np.zeros(7), np.zeros(7)

    def torque(self, time: float, q: Array, v: Array, M: Callable[[], Array]) -> Array:
        """Joint torques `(7,)` [N m], within the limits (Eq. 4).

        Args:
            time: now [s].
            q: measured positions `(7,)` [rad].
            v: measured velocities `(7,)` [rad/s].
            M: gives the arm's mass matrix `(7, 7)` [kg m^2]; called only to brake.
        """
        q_d, v_d, tau_ff = self.reference(time, q, v, M)
        if self.is_holding:  # a stop is not made slower by the bound on the torque's rate
            tau: Array = tau_ff + self._kp_hold * (q_d - q) + self._kd_hold * (v_d - v)
            self._tau = _between(tau, -self._limits.effort, self._limits.effort)
            return self._tau
        tau = tau_ff + self._kp * (q_d - q) + self._kd * (v_d - v)
        # The speed at which the setpoints drive each joint: their own, and that which their torque would
        # bring a joint to against the damping of the model. In contact it is where the arm pushes.
        w_d = v_d + tau_ff / self._kd_hold
        if self._governor is None or self._jacobian is None:
            tau += self._compensation(w_d)
        else:
            slowed = self._governor.slow_down(w_d, self._jacobian)
            tau += self._kd_hold * (slowed - w_d) + self._compensation(slowed)
            tau = self._governor.bound(tau, self._jacobian)
        tau = _between(tau, self._tau - self._torque_step, self._tau + self._torque_step)
        self._tau = _between(tau, -self._limits.effort, self._limits.effort)
        return self._tau

    def _compensation(self, w_d: Array) -> Array:
        """Torque `(7,)` [N m] against the friction of joints that are driven at `w_d` [rad/s]."""
        # tanh instead of the sign: no chattering about a speed of zero
        return np.asarray(self._friction * np.tanh(w_d / SLIDING))

    def _is_fresh(self, plan: Setpoints, time: float) -> bool:
        return time - self._received <= self._watchdog and time <= plan.time + plan.offsets[-1]


def _between(values: Array, lower: Array, upper: Array) -> Array:
    """What `np.clip` gives, in a fifth of its time for a few values."""
    return np.minimum(np.maximum(values, lower), upper)


def _check(setpoints: Setpoints, limits: JointLimits) -> None:
    rows, joints = len(setpoints.offsets), len(limits)
    bounds = {
        "q": (setpoints.q, limits.lower, limits.upper, "rad"),
        "v": (setpoints.v, -limits.velocity, limits.velocity, "rad/s"),
        "tau": (setpoints.tau, -limits.effort, limits.effort, "N m"),
    }
    if rows == 0 or not np.all(np.isfinite(setpoints.offsets)) or np.any(np.diff(setpoints.offsets) <= 0):
        given = np.array2string(setpoints.offsets, precision=3, threshold=6)
        raise MessageError(
            f"setpoint times are {given} s; they must be finite, rise, and number at least one"
        )
    for name, (values, lower, upper, unit) in bounds.items():
        if values.shape != (rows, joints):
            raise MessageError(f"setpoint {name} has shape {values.shape}; allowed: ({rows}, {joints})")
        if not np.all(np.isfinite(values)):
            raise MessageError(f"setpoint {name} is not finite")
        beyond = (values < lower - SLACK) | (values > upper + SLACK)
        if np.any(beyond):
            row, joint = np.argwhere(beyond)[0]
            raise MessageError(
                f"setpoint {name} of joint {joint + 1} is {values[row, joint]:.3f} {unit}; "
                f"allowed: {lower[joint]:.3f} to {upper[joint]:.3f}"
            )
