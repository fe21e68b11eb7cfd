"""What a robot's driver does with joint references: checks, interpolates, and stops without fresh ones."""

from __future__ import annotations

import numpy as np

from pack_core.errors import MessageError
from pack_core.joint_reference import JointReference
from pack_core.robots.joint_limits import JointLimits
from pack_core.rotations import Array

SLACK = 1e-3
"""Share of a limit that a reference may exceed it by: rounding, and rows between which it is a cubic."""


class ReferenceFollower:
    """Follows the newest reference; without a fresh one it brakes and holds.

    Args:
        limits: of the joints.
        watchdog: age at which a reference is stale [s].
        deceleration: of the stop, as a share of the acceleration limits.
    """

    def __init__(self, limits: JointLimits, watchdog: float, deceleration: float) -> None:
        self._limits = limits
        self._watchdog = watchdog
        self._braking = deceleration * limits.acceleration
        self._newest: JointReference | None = None
        self._received = -np.inf
        self._last: tuple[float, Array, Array] | None = None
        self.is_holding = True
        """Whether there is no fresh reference: the arm brakes or is held."""

    def accept(self, reference: JointReference, time: float) -> None:
        """Take a reference that arrived at `time` [s].

        Raises:
            MessageError: wrong size, not finite, out of order, or beyond a joint's limits.
        """
        _check(reference, self._limits)
        self._newest, self._received = reference, time

    def drop(self) -> None:
        """Forget the reference, as when its sender died."""
        self._newest = None

    def at(self, time: float, q: Array) -> tuple[Array, Array, Array]:
        """Desired position, velocity and acceleration `(n,)` at `time`, to be asked in every step.

        Args:
            time: now [s].
            q: measured positions `(n,)` [rad], where the arm is held that was never told anything.
        """
        newest = self._newest
        if newest is not None and time - self._received <= self._watchdog and time <= newest.end:
            self.is_holding = False
            desired = newest.at(time)
        else:
            self.is_holding = True
            desired = self._brake(time, q)
        self._last = (time, desired[0], desired[1])
        return desired

    def _brake(self, time: float, q: Array) -> tuple[Array, Array, Array]:
        """Every joint from its last desired speed to rest, and there it stays."""
        if self._last is None:
            return q.copy(), np.zeros_like(q), np.zeros_like(q)
        before, position, speed = self._last
        step = time - before
        change = np.clip(-speed, -self._braking * step, self._braking * step)
        v = speed + change
        position = np.clip(position + 0.5 * (speed + v) * step, self._limits.lower, self._limits.upper)
        return position, v, change / step if step > 0.0 else np.zeros_like(q)


def _check(reference: JointReference, limits: JointLimits) -> None:
    offsets, n = reference.offsets, len(limits)
    rows = len(offsets)
    if rows == 0 or not np.all(np.isfinite(offsets)) or np.any(np.diff(offsets) <= 0):
        raise MessageError("times of a reference must be finite, rise, and number at least one")
    for what, values, lower, upper, unit in (
        ("position", reference.q, limits.lower, limits.upper, "rad"),
        ("velocity", reference.v, -limits.velocity, limits.velocity, "rad/s"),
        ("acceleration", reference.a, -limits.acceleration, limits.acceleration, "rad/s^2"),
    ):
        if values.shape != (rows, n):
            raise MessageError(f"{what}s have shape {values.shape}; allowed: ({rows}, {n})")
        if not np.all(np.isfinite(values)):
            raise MessageError(f"a {what} is not finite")
        slack = SLACK * np.abs(upper)
        beyond = (values < lower - slack) | (values > upper + slack)
        if np.any(beyond):
            row, joint = np.argwhere(beyond)[0]
            raise MessageError(
                f"{what} of {limits.names[joint]} is {values[row, joint]:.3f} {unit}; "
                f"allowed: {lower[joint]:.3f} to {upper[joint]:.3f}"
            )
