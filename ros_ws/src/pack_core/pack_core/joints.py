"""Joints of an arm with n joints: as measured, and where they shall be over a horizon."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np

from pack_core.errors import PackError
from pack_core.rotations import Array

FeedForward = Literal["a", "tau"]
"""What setpoints state besides positions and velocities: accelerations, or the torques themselves."""
Desired = tuple[Array, Array, Array]
"""What joints shall do at a time: position [rad], velocity [rad/s] and what is fed forward, each `(n,)`."""


@dataclass(frozen=True)
class JointSample:
    """Measured joints at `time` [s]: `q` [rad], `v` [rad/s], `tau` [N m], each `(n,)`."""

    time: float
    q: Array
    v: Array
    tau: Array


@dataclass(frozen=True)
class Setpoints:
    """What the driver of n joints shall follow over a horizon.

    A controller that predicts with a model of the arm states the torque that its motion takes. Otherwise it
    states the acceleration, and the driver works the torque out.

    Attributes:
        time: of the first row [s].
        offsets: of each row from `time` `(T,)` [s], rising from 0.
        q: `(T, n)` [rad].
        v: `(T, n)` [rad/s].
        tau: feed-forward torque `(T, n)` [N m]; None where `a` is stated.
        a: `(T, n)` [rad/s^2]; None where `tau` is stated.
    """

    time: float
    offsets: Array
    q: Array
    v: Array
    tau: Array | None = None
    a: Array | None = None

    def __post_init__(self) -> None:
        if (self.tau is None) == (self.a is None):
            raise PackError("setpoints state torques or accelerations, one of them")

    @property
    def fed_forward(self) -> Array:
        """The torques [N m] or accelerations [rad/s^2] of the rows `(T, n)`, whichever they state."""
        stated = self.a if self.tau is None else self.tau
        assert stated is not None
        return stated

    @property
    def end(self) -> float:
        """Time of the last row [s]."""
        return self.time + float(self.offsets[-1])

    def at(self, time: float) -> Desired:
        """Position, velocity and torque or acceleration at `time` [s], held beyond the ends.

        Rows with accelerations are those of a smooth motion: between them the position is the cubic that has
        the rows' positions and velocities (Hermite), and the velocity its derivative. Rows with torques come
        from a model that was driven along straight lines between them, velocities included.
        """
        offset, offsets = time - self.time, self.offsets
        last = len(offsets) - 1
        i = min(max(int(offsets.searchsorted(offset, side="right")) - 1, 0), last)
        h = float(offsets[i + 1] - offsets[i]) if i < last else 0.0
        s = min(max((offset - float(offsets[i])) / h, 0.0), 1.0) if h > 0.0 else 0.0
        if s == 0.0:
            return self.q[i].copy(), self.v[i].copy(), self.fed_forward[i].copy()
        if self.a is None:
            q, v, tau = (1.0 - s) * self._rows[:, i] + s * self._rows[:, i + 1]
            return q, v, tau
        q_0, q_1, v_0, v_1 = self.q[i], self.q[i + 1], self.v[i], self.v[i + 1]
        # Cubic Hermite over a row distance h, s from 0 to 1: q = q0 + (3 s^2 - 2 s^3)(q1 - q0)
        # + h s (1 - s)^2 v0 - h s^2 (1 - s) v1, and v is its derivative by time.
        b = s * s * (3.0 - 2.0 * s)
        q = q_0 + b * (q_1 - q_0) + h * s * (1.0 - s) * ((1.0 - s) * v_0 - s * v_1)
        v = (6.0 * s * (1.0 - s) / h) * (q_1 - q_0)
        v += (1.0 - s) * (1.0 - 3.0 * s) * v_0 + s * (3.0 * s - 2.0) * v_1
        return q, v, (1.0 - s) * self.a[i] + s * self.a[i + 1]

    def until(self, offset: float) -> Setpoints:
        """The rows up to `offset` [s] from the first."""
        n = int(np.searchsorted(self.offsets, offset, side="right"))
        rows = (None if column is None else column[:n] for column in (self.tau, self.a))
        return Setpoints(self.time, self.offsets[:n], self.q[:n], self.v[:n], *rows)

    @cached_property
    def _rows(self) -> Array:
        """Positions, velocities and torques `(3, T, n)`."""
        return np.stack([self.q, self.v, self.fed_forward])


def hold(joints: JointSample) -> Setpoints:
    """Setpoints that run out at once, so that the driver holds the arm where it is."""
    zero = np.zeros((1, len(joints.q)))
    return Setpoints(joints.time, np.zeros(1), joints.q[None], zero, zero)
