"""Joints of an arm with n joints: as measured, and where they shall be, now or over a horizon."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from pack_core.rotations import Array


@dataclass(frozen=True)
class JointReference:
    """Rows of a reference for n joints.

    Attributes:
        time: of the first row [s].
        offsets: of each row from `time` `(T,)` [s], rising from 0.
        q: `(T, n)` [rad].
        v: `(T, n)` [rad/s].
        a: `(T, n)` [rad/s^2].
    """

    time: float
    offsets: Array
    q: Array
    v: Array
    a: Array

    @property
    def end(self) -> float:
        """Time of the last row [s]."""
        return self.time + float(self.offsets[-1])

    def at(self, time: float) -> tuple[Array, Array, Array]:
        """Position, velocity and acceleration `(n,)` at `time` [s], held beyond the ends.

        Between rows the position is the cubic that has the rows' positions and velocities (Hermite),
        the velocity its derivative; the acceleration is interpolated.
        """
        offset, offsets = time - self.time, self.offsets
        last = len(offsets) - 1
        i = min(max(int(np.searchsorted(offsets, offset, side="right")) - 1, 0), last)
        h = float(offsets[i + 1] - offsets[i]) if i < last else 0.0
        s = min(max((offset - float(offsets[i])) / h, 0.0), 1.0) if h > 0.0 else 0.0
        if s == 0.0:
            return self.q[i].copy(), self.v[i].copy(), self.a[i].copy()
        q_0, q_1, v_0, v_1 = self.q[i], self.q[i + 1], self.v[i], self.v[i + 1]
        # Cubic Hermite over a row distance h, s from 0 to 1: q = q0 + (3 s^2 - 2 s^3)(q1 - q0)
        # + h s (1 - s)^2 v0 - h s^2 (1 - s) v1, and v is its derivative by time.
        b = s * s * (3.0 - 2.0 * s)
        q = q_0 + b * (q_1 - q_0) + h * s * (1.0 - s) * ((1.0 - s) * v_0 - s * v_1)
        v = (6.0 * s * (1.0 - s) / h) * (q_1 - q_0)
        v += (1.0 - s) * (1.0 - 3.0 * s) * v_0 + s * (3.0 * s - 2.0) * v_1
        return q, v, (1.0 - s) * self.a[i] + s * self.a[i + 1]


@dataclass(frozen=True)
class JointSetpoint:
    """What the driver shall follow at `time` [s]: `q` [rad], `v` [rad/s], `a` [rad/s^2], each `(n,)`."""

    time: float
    q: Array
    v: Array
    a: Array


@dataclass(frozen=True)
class JointSample:
    """Measured joints at `time` [s]: `q` [rad], `v` [rad/s], `tau` [N m], each `(n,)`."""

    time: float
    q: Array
    v: Array
    tau: Array


@dataclass(frozen=True)
class Setpoints:
    """Joint references over a horizon, with feed-forward torques.

    Attributes:
        time: of the first row [s].
        offsets: of each row from `time` `(T,)` [s], rising from 0.
        q: `(T, n)` [rad].
        v: `(T, n)` [rad/s].
        tau: feed-forward torque `(T, n)` [N m].
    """

    time: float
    offsets: Array
    q: Array
    v: Array
    tau: Array

    def at(self, time: float) -> tuple[Array, Array, Array]:
        """Position, velocity and torque `(n,)` at `time` [s]: interpolated, and held beyond the ends."""
        offset, offsets = time - self.time, self.offsets
        last = len(offsets) - 1
        i = min(max(int(offsets.searchsorted(offset, side="right")) - 1, 0), last)
        j = min(i + 1, last)
        span = offsets[j] - offsets[i]
        s = min(max((offset - offsets[i]) / span, 0.0), 1.0) if span > 0 else 0.0
        q, v, tau = (1 - s) * self._rows[:, i] + s * self._rows[:, j]
        return q, v, tau

    @cached_property
    def _rows(self) -> Array:
        """Positions, velocities and torques `(3, T, n)`."""
        return np.stack([self.q, self.v, self.tau])

    def until(self, offset: float) -> Setpoints:
        """The rows up to `offset` [s] from the first."""
        n = int(np.searchsorted(self.offsets, offset, side="right"))
        return Setpoints(self.time, self.offsets[:n], self.q[:n], self.v[:n], self.tau[:n])
