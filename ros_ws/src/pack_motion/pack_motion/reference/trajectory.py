"""A joint reference over time as rows, with quintic interpolation between them; or why there is none."""

from __future__ import annotations

from dataclasses import dataclass

import numba
import numpy as np
import numpy.typing as npt

from pack_core.errors import PackError
from pack_core.rotations import Array

GRID = 0.004
"""Longest time between rows [s]."""
SAME_TIME = 1e-6
"""Rows are not nearer to each other than this [s], so that they differ in whole nanoseconds, too."""
REST_SPEED, REST_ACCELERATION = 1e-3, 2e-2
"""Below both a joint counts as standing still [rad/s, rad/s^2]."""


@dataclass(frozen=True)
class JointState:
    """Positions [rad], velocities [rad/s] and accelerations [rad/s^2] of the joints, each `(n,)`."""

    q: Array
    v: Array
    a: Array

    @classmethod
    def at_rest(cls, q: Array) -> JointState:
        """A state at `q` with zero velocity and acceleration."""
        return cls(np.array(q, dtype=float), np.zeros(len(q)), np.zeros(len(q)))

    @property
    def is_at_rest(self) -> bool:
        """Whether all joints stand still, except for the small motions that tracking leaves."""
        return bool(np.abs(self.v).max() < REST_SPEED and np.abs(self.a).max() < REST_ACCELERATION)


@dataclass(frozen=True)
class ReferenceTrajectory:
    """Rows of a reference.

    Attributes:
        times: time of each row `(T,)` [s], rising from 0.
        q: joint positions `(T, n)` [rad].
        v: joint velocities `(T, n)` [rad/s].
        a: joint accelerations `(T, n)` [rad/s^2].
        segment: index of the segment of the path that leads to each row `(T,)`.
    """

    times: Array
    q: Array
    v: Array
    a: Array
    segment: npt.NDArray[np.int64]

    @property
    def duration(self) -> float:
        """Time of the last row [s]."""
        return float(self.times[-1])

    @property
    def start(self) -> JointState:
        """State of the first row."""
        return JointState(self.q[0], self.v[0], self.a[0])

    @property
    def end(self) -> JointState:
        """State of the last row."""
        return JointState(self.q[-1], self.v[-1], self.a[-1])

    def at(self, time: float) -> tuple[JointState, int]:
        """State and segment at `time` [s], held beyond the ends.

        Between rows it is the quintic that has the positions, velocities and accelerations of both rows.
        """
        times = self.times
        if time <= 0.0 or time >= times[-1]:
            row = 0 if time <= 0.0 else -1
            return JointState(self.q[row], self.v[row], self.a[row]), int(self.segment[row])
        i = int(times.searchsorted(time, side="right")) - 1
        h = float(times[i + 1] - times[i])
        # Contiguous, so that one compiled function serves every reference.
        rows = (np.ascontiguousarray(column[i : i + 2]) for column in (self.q, self.v, self.a))
        return JointState(*_quintic((time - float(times[i])) / h, h, *rows)), int(self.segment[i + 1])

    def after(self, time: float) -> ReferenceTrajectory:
        """The reference from `time` [s] on; its first row is the state then."""
        start, segment = self.at(time)
        rest = self.times > time + SAME_TIME
        q, v, a = (
            np.concatenate([first[None], rows[rest]])
            for first, rows in ((start.q, self.q), (start.v, self.v), (start.a, self.a))
        )
        times = np.concatenate([[0.0], self.times[rest] - time])
        return ReferenceTrajectory(times, q, v, a, np.concatenate([[segment], self.segment[rest]]))

    def followed_by(self, other: ReferenceTrajectory) -> ReferenceTrajectory:
        """This reference and then another one, whose first row must be the last row of this one."""
        columns = zip(
            (self.q, self.v, self.a, self.segment), (other.q, other.v, other.a, other.segment), strict=True
        )
        q, v, a, segment = (np.concatenate([mine, theirs[1:]]) for mine, theirs in columns)
        return ReferenceTrajectory(
            np.concatenate([self.times, self.duration + other.times[1:]]), q, v, a, segment
        )


def grid(duration: float) -> Array:
    """Evenly spaced times of rows for a duration [s], both ends included."""
    return np.linspace(0.0, duration, max(int(np.ceil(duration / GRID)), 1) + 1)


@numba.njit(cache=True)
def _quintic(s: float, h: float, q: Array, v: Array, a: Array) -> tuple[Array, Array, Array]:
    """The quintic Hermite polynomial between two rows, `h` [s] apart, at the share `s` of that time.

    Derivatives are scaled by h and h^2 to those by s; c3 to c5 are the coefficients of s^3 to s^5.
    """
    d, v_0, v_1, a_0, a_1 = q[1] - q[0], h * v[0], h * v[1], h * h * a[0], h * h * a[1]
    c3 = 10 * d - 6 * v_0 - 4 * v_1 - 1.5 * a_0 + 0.5 * a_1
    c4 = -15 * d + 8 * v_0 + 7 * v_1 + 1.5 * a_0 - a_1
    c5 = 6 * d - 3 * v_0 - 3 * v_1 - 0.5 * a_0 + 0.5 * a_1
    at = q[0] + s * (v_0 + s * (0.5 * a_0 + s * (c3 + s * (c4 + s * c5))))
    rate = v_0 + s * (a_0 + s * (3 * c3 + s * (4 * c4 + s * 5 * c5)))
    bend = a_0 + s * (6 * c3 + s * (12 * c4 + s * 20 * c5))
    return at, rate / h, bend / (h * h)


class MoveRefused(PackError):
    """A move must not start; the text names the part of the move and the reason."""
