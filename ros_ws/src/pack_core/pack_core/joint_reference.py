"""Where joints shall be over a horizon: positions, velocities and accelerations."""

from __future__ import annotations

from dataclasses import dataclass

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
        b = s * s * (3.0 - 2.0 * s)
        q = q_0 + b * (q_1 - q_0) + h * s * (1.0 - s) * ((1.0 - s) * v_0 - s * v_1)
        v = (6.0 * s * (1.0 - s) / h) * (q_1 - q_0)
        v += (1.0 - s) * (1.0 - 3.0 * s) * v_0 + s * (3.0 * s - 2.0) * v_1
        return q, v, (1.0 - s) * self.a[i] + s * self.a[i + 1]
