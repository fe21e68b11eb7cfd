"""Lets the reference slow down near what moves, and wait while the tool is held up."""

from __future__ import annotations

import numpy as np

from pack_core.kinematics.chain import SerialChain
from pack_core.rotations import Array
from pack_motion.reference.trajectory import JointState
from pack_motion.tracking.config import Governor


class RateGovernor:
    """The rate at which the reference goes on: 1 as planned, 0 standing still.

    Args:
        config: distances and speeds.
        chain: of the arm.
        acceleration: limits of the joints `(n,)` [rad/s^2].
    """

    def __init__(self, config: Governor, chain: SerialChain, acceleration: Array) -> None:
        self._config, self._chain, self._acceleration = config, chain, acceleration
        self.rate = 1.0

    def update(self, planned: JointState, deviation: float, distance: float, h: float) -> float:
        """The rate after a step.

        Args:
            planned: the reference at rate 1, now.
            deviation: of the tool from the reference [m].
            distance: least, to what is felt around [m]; infinite where nothing is.
            h: duration of the step [s].
        """
        c = self._config
        wished = min(max((c.far - deviation) / (c.far - c.near), 0.0), 1.0)
        if np.isfinite(distance):
            wished = min(wished, self._allowed_speed(distance) / max(self._tool_speed(planned), 1e-6))
        slowest, fastest = self._changes(planned)
        self.rate = min(max(self.rate + min(max(wished - self.rate, h * slowest), h * fastest), 0.0), 1.0)
        return self.rate

    def _allowed_speed(self, distance: float) -> float:
        """Of the tool [m/s]: it can still come down to `avoid_speed` at `avoid_distance`."""
        c = self._config
        room = max(distance - c.avoid_distance, 0.0)
        return float(np.sqrt(c.avoid_speed**2 + 2.0 * c.avoid_deceleration * room))

    def _tool_speed(self, planned: JointState) -> float:
        return float(np.linalg.norm((self._chain.jacobian(planned.q) @ planned.v)[:3]))

    def _changes(self, planned: JointState) -> tuple[float, float]:
        """Slowest and fastest change of the rate [1/s] that the joints can follow."""
        moves = np.abs(planned.v) > 1e-6
        if not np.any(moves):
            return -1.0 / self._config.time, 1.0 / self._config.time
        v, sign = np.abs(planned.v[moves]), np.sign(planned.v[moves])
        along = self.rate**2 * sign * planned.a[moves]
        limit = self._acceleration[moves]
        slowest, fastest = ((-limit - along) / v).max(), ((limit - along) / v).min()
        most = 1.0 / self._config.time
        return max(min(float(slowest), 0.0), -most), min(max(float(fastest), 0.0), most)
