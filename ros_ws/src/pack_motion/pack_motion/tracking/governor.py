"""Slows the reference down near moving obstacles, and makes it wait while the tool is held up."""

from __future__ import annotations

import numpy as np

from pack_core.kinematics.chain import SerialChain
from pack_core.rotations import Array
from pack_motion.reference.trajectory import JointState
from pack_motion.tracking.config import Governor


class RateGovernor:
    """Chooses the rate at which the reference advances: 1 is as planned, 0 is standing still.

    Args:
        config: distances and speeds.
        chain: the arm's kinematics.
        acceleration: acceleration limits of the joints `(n,)` [rad/s^2].
    """

    def __init__(self, config: Governor, chain: SerialChain, acceleration: Array) -> None:
        self._config, self._chain, self._acceleration = config, chain, acceleration
        self.rate = 1.0

    def update(self, planned: JointState, deviation: float, distance: float, h: float) -> float:
        """The rate after a step.

        Args:
            planned: the present state of the reference, at rate 1.
            deviation: distance of the tool from the reference [m].
            distance: smallest distance to an obstacle that the policies react to [m]; infinite if none.
            h: duration of the step [s].
        """
        c = self._config
        # Falls linearly from 1 where the tool is `near` its reference to 0 where it is `far` from it.
        wished = min(max((c.far - deviation) / (c.far - c.near), 0.0), 1.0)
        if np.isfinite(distance):
            wished = min(wished, self._allowed_speed(distance) / max(self._tool_speed(planned), 1e-6))
        slowest, fastest = self._changes(planned)
        self.rate = min(max(self.rate + min(max(wished - self.rate, h * slowest), h * fastest), 0.0), 1.0)
        return self.rate

    def _allowed_speed(self, distance: float) -> float:
        """Speed of the tool [m/s] from which it can brake to `avoid_speed` at `avoid_distance`."""
        c = self._config
        room = max(distance - c.avoid_distance, 0.0)
        # v^2 = v_0^2 + 2 a s
        return float(np.sqrt(c.avoid_speed**2 + 2.0 * c.avoid_deceleration * room))

    def _tool_speed(self, planned: JointState) -> float:
        return float(np.linalg.norm((self._chain.jacobian(planned.q) @ planned.v)[:3]))

    def _changes(self, planned: JointState) -> tuple[float, float]:
        """Bounds of the change of the rate [1/s] within which every joint keeps its acceleration limit.

        At the rate r joints move at r v and accelerate at r^2 a + v dr/dt, which bounds dr/dt for each joint.
        """
        moves = np.abs(planned.v) > 1e-6
        if not np.any(moves):
            return -1.0 / self._config.time, 1.0 / self._config.time
        v, sign = np.abs(planned.v[moves]), np.sign(planned.v[moves])
        along = self.rate**2 * sign * planned.a[moves]
        limit = self._acceleration[moves]
        slowest, fastest = ((-limit - along) / v).max(), ((limit - along) / v).min()
        most = 1.0 / self._config.time
        return max(min(float(slowest), 0.0), -most), min(max(float(fastest), 0.0), most)
