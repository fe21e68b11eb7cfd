"""How a driver takes setpoints: which it refuses, which are in force, and when it must stop by itself."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from pack_core.errors import MessageError
from pack_core.joints import Desired, FeedForward, Setpoints
from pack_core.robots.joint_properties import JointLimits
from pack_core.rotations import Array

SLACK = 1e-3
"""A limit may be exceeded by this share of it, for rounding and for the cubic between rows."""
LEAD = 1.0
"""How far ahead of the driver's clock setpoints may begin [s]. A plan begins tens of milliseconds ahead; one
that begins much later was stamped by another clock, and its time would never come."""
SAME_TIME = 1e-6
"""Setpoints that begin by no more than this later than now begin now, but for rounding [s]."""
ROUNDING = 1e-9
"""Setpoints still count this long after their last row [s], for sums of periods that are rounded."""


class Brake(Protocol):
    """Brings an arm to rest without setpoints, holds it, and leads it back to those that come."""

    feed_forward: FeedForward
    """What setpoints of such an arm must state."""
    slow_down: float
    """How long the arm goes on along overdue setpoints, ever slower, before it is braked [s]."""

    def hold(self, time: float, q: Array, v: Array, *, is_late: bool) -> Desired:
        """What the joints shall do at `time` [s] without setpoints.

        Args:
            time: now [s].
            q: measured positions `(n,)` [rad].
            v: measured velocities `(n,)` [rad/s].
            is_late: whether there were setpoints, and only the next ones are overdue. Otherwise they were
                dropped, as their sender died or somebody wants the arm to stop.
        """
        ...

    def check(self, setpoints: Setpoints, time: float) -> None:
        """Check that the arm may go on from where it is held; raises MessageError when it may not."""
        ...

    def follow(self, setpoints: Setpoints, time: float) -> Desired:
        """What the joints shall do at `time` [s] with setpoints."""
        ...


class SetpointFollower:
    """Follows the newest setpoints; without fresh ones it slows down, brakes and holds the arm.

    Args:
        limits: limits of the joints.
        watchdog: age at which setpoints are stale [s].
        brake: how the arm is stopped and held.
    """

    def __init__(self, limits: JointLimits, watchdog: float, brake: Brake) -> None:
        self._names, self._watchdog, self._brake = limits.names, watchdog, brake
        self._bounds = {
            "q": _Bounds("position", "rad", limits.lower, limits.upper),
            "v": _Bounds("velocity", "rad/s", -limits.velocity, limits.velocity),
            "a": _Bounds("acceleration", "rad/s^2", -limits.acceleration, limits.acceleration),
            "tau": _Bounds("torque", "N m", -limits.effort, limits.effort),
        }
        self._setpoints: Setpoints | None = None
        self._next: Setpoints | None = None
        self._received = -np.inf
        self.is_holding = False
        """Whether the arm was braked or held when `at` was called last, for want of fresh setpoints."""

    @property
    def feed_forward(self) -> FeedForward:
        """What setpoints must state besides positions and velocities."""
        return self._brake.feed_forward

    def accept(self, setpoints: Setpoints, time: float) -> None:
        """Take setpoints that arrived at `time` [s].

        Those that come early wait for the time of their first row, which is where the arm will be by then,
        and the arm goes on with the ones before. They wait no longer than until others come.

        Raises:
            MessageError: wrong size, not finite, out of order, beyond a joint's limits, of another clock, or
                not from where the arm is held.
        """
        self._check(setpoints)
        if setpoints.time > time + LEAD:
            raise MessageError(
                f"setpoints begin {setpoints.time - time:.3f} s ahead of the driver's time {time:.3f} s; "
                f"allowed: {LEAD:.3f} s. Their stamp must be of the clock that stamps the joint states"
            )
        self._brake.check(setpoints, time)
        if setpoints.time > time + SAME_TIME:
            self._setpoints, self._next = self._next or self._setpoints, setpoints
        else:
            self._setpoints, self._next = setpoints, None
        self._received = time

    def drop(self) -> None:
        """Discard the setpoints, as when their sender died: brake and hold from the next step on."""
        self._setpoints = self._next = None

    def at(self, time: float, q: Array, v: Array) -> Desired:
        """What the joints shall do now; to be called in every step.

        Args:
            time: now [s].
            q: measured positions `(n,)` [rad].
            v: measured velocities `(n,)` [rad/s].
        """
        if self._next is not None and time >= self._next.time - SAME_TIME:
            self._setpoints, self._next = self._next, None
        plan = self._setpoints
        overdue, slow_down = time - self._received - self._watchdog, self._brake.slow_down
        self.is_holding = plan is None or overdue > slow_down or time > plan.end + ROUNDING
        if plan is None or self.is_holding:
            return self._brake.hold(time, q, v, is_late=plan is not None)
        if overdue <= 0.0:
            return self._brake.follow(plan, time)
        # Speed falls evenly to zero: the plan's own time advances by the integral of this pace.
        pace = 1.0 - overdue / slow_down
        q_d, v_d, fed_forward = self._brake.follow(plan, time - 0.5 * overdue**2 / slow_down)
        return q_d, pace * v_d, fed_forward

    def _check(self, setpoints: Setpoints) -> None:
        offsets, shape = setpoints.offsets, (len(setpoints.offsets), len(self._names))
        if len(offsets) == 0 or not np.isfinite(offsets).all() or (offsets[1:] <= offsets[:-1]).any():
            given = np.array2string(offsets, precision=3, threshold=6)
            raise MessageError(
                f"setpoint times are {given} s; they must be finite, rise, and number at least one"
            )
        for column in ("q", "v", self._brake.feed_forward):
            values, bounds = getattr(setpoints, column), self._bounds[column]
            if values is None or values.shape != shape:
                size = None if values is None else values.shape
                raise MessageError(f"setpoint {column} has shape {size}; allowed: {shape}")
            if not ((values >= bounds.least) & (values <= bounds.most)).all():  # also where one is NaN
                if not np.isfinite(values).all():
                    raise MessageError(f"setpoint {column}: a {bounds.what} is not finite")
                raise MessageError(bounds.excess(values, self._names))


class _Bounds:
    """Allowed values of one column of the setpoints, `lower` to `upper` `(n,)`."""

    def __init__(self, what: str, unit: str, lower: Array, upper: Array) -> None:
        self.what, self._unit, self._lower, self._upper = what, unit, lower, upper
        slack = SLACK * np.abs(upper)
        self.least, self.most = lower - slack, upper + slack

    def excess(self, values: Array, names: tuple[str, ...]) -> str:
        """An error text about the first of `values` `(T, n)` that is beyond its bounds."""
        row, joint = np.argwhere((values < self.least) | (values > self.most))[0]
        return (
            f"{self.what} of {names[joint]} is {values[row, joint]:.3f} {self._unit}; "
            f"allowed: {self._lower[joint]:.3f} to {self._upper[joint]:.3f}"
        )
