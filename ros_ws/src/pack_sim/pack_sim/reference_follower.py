"""How the robot's driver follows joint references: interpolates, stops when they are stale, and rejoins."""

from __future__ import annotations

import numpy as np

from pack_core.errors import MessageError
from pack_core.joints import JointReference
from pack_core.robots.joint_limits import JointLimits
from pack_core.rotations import Array
from pack_sim.gentle_stop import Desired, GentleStop
from pack_sim.reference_check import ReferenceCheck
from pack_sim.rejoining import Rejoining

LEAD = 0.1
"""How far ahead of the driver's clock a reference may begin [s]. It begins at a time that has come, by the
sender's last joint state; one that begins later would have the arm stand at its first row until then."""

ROUNDING = 1e-9
"""A reference still counts this long after its last row [s], for sums of periods that are rounded."""


class ReferenceFollower:
    """Follows the newest reference; without a fresh one it brakes and holds the arm.

    An arm that was held follows a new reference only if that begins near where it stands: see `Rejoining`.

    Args:
        limits: limits of the joints.
        watchdog: age at which a reference is stale [s].
        deceleration: deceleration of the stop, as a share of the acceleration limits.
    """

    def __init__(self, limits: JointLimits, watchdog: float, deceleration: float) -> None:
        self._limits, self._check = limits, ReferenceCheck(limits)
        self._watchdog = watchdog
        self._deceleration = deceleration
        self._newest: JointReference | None = None
        self._received = -np.inf
        self._last: tuple[float, Desired] | None = None
        self._stop: GentleStop | None = None
        self._rejoining: Rejoining | None = None
        self.is_holding = True
        """Whether the arm brakes or is held, since there is no fresh reference."""

    def accept(self, reference: JointReference, time: float) -> None:
        """Take a reference that arrived at `time` [s].

        Raises:
            MessageError: wrong size, not finite, out of order, or beyond a joint's limits; or it does not
                begin where the arm was held, or begins later than now, as by another clock.
        """
        self._check.check(reference)
        if reference.time > time + LEAD:
            raise MessageError(
                f"the reference begins {reference.time - time:.3f} s ahead of the driver's {time:.3f} s; "
                f"allowed: {LEAD} s. Its stamp must be of the clock that stamps the joint states"
            )
        if self._rejoining is not None and self._last is not None:
            self._rejoining.check(reference, *self._last)
        self._newest, self._received = reference, time

    def drop(self) -> None:
        """Forget the reference, for example when the node that sent it has ended."""
        self._newest = None

    def at(self, time: float, q: Array) -> Desired:
        """Desired position, velocity and acceleration `(n,)` at `time`; to be called in every step.

        Args:
            time: now [s].
            q: measured positions `(n,)` [rad]; the arm is held there before its first reference.
        """
        newest = self._newest
        if newest is not None and time - self._received <= self._watchdog and time <= newest.end + ROUNDING:
            self.is_holding, self._stop = False, None
            desired = self._follow(newest, time)
        else:
            self.is_holding = True
            desired = self._hold(time, q)
        self._last = (time, desired)
        return desired

    def _follow(self, reference: JointReference, time: float) -> Desired:
        if self._rejoining is None or self._last is None:
            return reference.at(time)
        desired, is_there = self._rejoining.step(reference, time, *self._last)
        if is_there:
            self._rejoining = None
        return desired

    def _hold(self, time: float, q: Array) -> Desired:
        if self._stop is None:
            rest = np.zeros(len(self._limits))
            before, moving = self._last or (time, (q.copy(), rest, rest))
            self._stop = GentleStop(before, moving, self._limits, self._deceleration)
            self._rejoining = Rejoining(self._limits)
        return self._stop.at(time)
