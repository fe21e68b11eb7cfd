"""Fastest jerk-limited moves between joint states (ruckig)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import ruckig

from pack_core.rotations import Array
from pack_motion.reference.trajectory import JointState, MoveRefused, ReferenceTrajectory, grid

SHARES = (1.0, 0.9997, 0.998, 0.99)
"""Shares of the jerk limit that are tried: ruckig may fail for limits at which a phase just vanishes."""


def fastest(request: ruckig.InputParameter) -> ruckig.Trajectory | None:
    """The fastest trajectory for a request, or None where there is none."""
    jerk = list(request.max_jerk)
    for share in SHARES:
        request.max_jerk = [share * limit for limit in jerk]
        found = ruckig.Trajectory(len(jerk))
        try:
            outcome = ruckig.Ruckig(len(jerk)).calculate(request, found)
        except ruckig.RuckigError:
            continue
        if outcome in (ruckig.Result.Working, ruckig.Result.Finished):
            return found
    return None


SLACK = 1.001
"""The limits of a move are at least this times the velocity and acceleration at its ends, for rounding."""


@dataclass(frozen=True)
class MoveLimits:
    """Velocity [rad/s], acceleration [rad/s^2] and jerk [rad/s^3], each `(n,)`."""

    velocity: Array
    acceleration: Array
    jerk: Array

    def scaled(self, speed: float, acceleration: float) -> MoveLimits:
        """A share of the velocity limits and one of the acceleration limits, which scales the jerk too."""
        return MoveLimits(speed * self.velocity, acceleration * self.acceleration, acceleration * self.jerk)


def joint_move(start: JointState, end: JointState, limits: MoveLimits, segment: int) -> ReferenceTrajectory:
    """The fastest move from `start` to `end` in which all joints arrive at the same time.

    Raises:
        MoveRefused: ruckig finds no move.
    """
    request = ruckig.InputParameter(len(start.q))
    request.current_position, request.target_position = start.q, end.q
    request.target_velocity, request.target_acceleration = end.v, end.a
    return _solve(request, start, end, limits, segment)


def brake(start: JointState, limits: MoveLimits, segment: int) -> ReferenceTrajectory:
    """The fastest stop; each joint comes to rest as soon as it can, wherever that is."""
    request = ruckig.InputParameter(len(start.q))
    request.control_interface = ruckig.ControlInterface.Velocity
    request.synchronization = ruckig.Synchronization.No
    request.current_position = start.q
    return _solve(request, start, JointState.at_rest(start.q), limits, segment)


def _solve(
    request: ruckig.InputParameter, start: JointState, end: JointState, limits: MoveLimits, segment: int
) -> ReferenceTrajectory:
    request.current_velocity, request.current_acceleration = start.v, start.a
    request.max_velocity = _at_least(limits.velocity, start.v, end.v)
    request.max_acceleration = _at_least(limits.acceleration, start.a, end.a)
    request.max_jerk = limits.jerk
    found = fastest(request)
    if found is None:
        raise MoveRefused(f"no move from joints {start.q.round(3).tolist()} to {end.q.round(3).tolist()} rad")
    return sampled(found, segment)


def sampled(found: ruckig.Trajectory, segment: int) -> ReferenceTrajectory:
    """Sample a trajectory of ruckig at rows `GRID` or less apart."""
    times = grid(found.duration)
    rows = np.array([found.at_time(float(time)) for time in times])
    return ReferenceTrajectory(times, rows[:, 0], rows[:, 1], rows[:, 2], np.full(len(times), segment))


def _at_least(limit: Array, first: Array, last: Array) -> Array:
    return np.maximum(limit, SLACK * np.maximum(np.abs(first), np.abs(last)))
