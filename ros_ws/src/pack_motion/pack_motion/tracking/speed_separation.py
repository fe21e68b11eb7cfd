"""Slows the reference down near moving obstacles, and makes it wait while the tool is held up."""

from __future__ import annotations

from dataclasses import dataclass

import numba
import numpy as np

from pack_core.kinematics.chain import SerialChain
from pack_core.rotations import Array
from pack_motion.reference.trajectory import JointState
from pack_motion.tracking.config import SpeedSeparation

STILL = 1e-6
"""Joints that are slower do not bound the change of the rate [rad/s]."""


@dataclass(frozen=True)
class Threat:
    """The obstacle nearest to the arm.

    Attributes:
        distance: from it to the arm and what it carries [m]; infinite where there is none.
        speed: of the obstacle [m/s].
        is_blind: whether obstacles were seen, and nothing has been heard of them for too long.
    """

    distance: float = np.inf
    speed: float = 0.0
    is_blind: bool = False


class SpeedSeparationMonitor:
    """Chooses the rate at which the reference advances: 1 is as planned, 0 is standing still.

    Args:
        config: distances and speeds.
        chain: the arm's kinematics.
        acceleration: acceleration limits of the joints `(n,)` [rad/s^2].
    """

    def __init__(self, config: SpeedSeparation, chain: SerialChain, acceleration: Array) -> None:
        self._config, self._chain, self._acceleration = config, chain, acceleration
        self.rate = 1.0
        self.gives_way = False
        """Whether an obstacle moves near the arm, or has just done so."""
        self._calm = np.inf

    def update(self, planned: JointState, deviation: float, threat: Threat, h: float) -> float:
        """The rate after a step.

        Args:
            planned: the present state of the reference, at rate 1.
            deviation: distance of the tool from the reference [m].
            threat: the nearest obstacle that the policies react to.
            h: duration of the step [s].
        """
        c = self._config
        # Falls linearly from 1 where the tool is `near` its reference to 0 where it is `far` from it.
        wished = min(max((c.far - deviation) / (c.far - c.near), 0.0), 1.0)
        if threat.is_blind:
            wished = 0.0
        elif np.isfinite(threat.distance):
            wished = min(wished, self._allowed_speed(threat) / max(self._tool_speed(planned), 1e-6))
        is_near = threat.distance < c.avoid_distance + c.stop_distance + c.reaction * threat.speed
        is_calm = not threat.is_blind and not (is_near and threat.speed > c.moving_speed)
        self._calm = self._calm + h if is_calm else 0.0
        self.gives_way = self._calm < c.calm_time
        slowest, fastest = rate_changes(self.rate, planned.v, planned.a, self._acceleration, 1.0 / c.time)
        self.rate = min(max(self.rate + min(max(wished - self.rate, h * slowest), h * fastest), 0.0), 1.0)
        return self.rate

    def _allowed_speed(self, threat: Threat) -> float:
        """Speed of the tool [m/s] from which it can brake in time.

        The distance to an obstacle that moves at `v_o` is kept at or above `v^2 / 2a + d_0 + t_r v_o`, with
        the tool's speed `v`, `a` = `avoid_deceleration`, `d_0` = `stop_distance`, `t_r` = `reaction`. Near
        one that stands the tool brakes to `avoid_speed` at `avoid_distance`: the policies lead it around.

        This is not the protective separation distance of ISO/TS 15066, 5.5.4, which is larger: there the
        person walks on while the robot stops, too, the robot goes on while it reacts, and intrusion and the
        uncertainty of both positions are added. Also, only the tool's speed is bounded.
        """
        c = self._config
        if threat.speed > c.moving_speed:
            room = max(threat.distance - c.stop_distance - c.reaction * threat.speed, 0.0)
            return float(np.sqrt(2.0 * c.avoid_deceleration * room))
        room = max(threat.distance - c.avoid_distance, 0.0)
        # v^2 = v_0^2 + 2 a s
        return float(np.sqrt(c.avoid_speed**2 + 2.0 * c.avoid_deceleration * room))

    def _tool_speed(self, planned: JointState) -> float:
        return float(np.linalg.norm((self._chain.jacobian(planned.q) @ planned.v)[:3]))


@numba.njit(cache=True)
def rate_changes(rate: float, v: Array, a: Array, limit: Array, most: float) -> tuple[float, float]:
    """Bounds of the change of the rate [1/s] within which every joint keeps its acceleration limit.

    At the rate r joints move at r v and accelerate at r^2 a + v dr/dt, which bounds dr/dt for each joint.

    Args:
        rate: at which the reference advances.
        v: of the joints at rate 1 `(n,)` [rad/s].
        a: likewise `(n,)` [rad/s^2].
        limit: of their accelerations `(n,)` [rad/s^2].
        most: largest change [1/s].
    """
    slowest, fastest = -most, most
    for i in range(len(v)):
        speed = abs(v[i])
        if speed > STILL:
            along = rate**2 * np.sign(v[i]) * a[i]
            slowest = max(slowest, (-limit[i] - along) / speed)
            fastest = min(fastest, (limit[i] - along) / speed)
    return min(slowest, 0.0), max(fastest, 0.0)
