"""Joint accelerations that keep every limit."""

from __future__ import annotations

import numpy as np

from pack_core.robots.joint_limits import JointLimits
from pack_core.rotations import Array

BRAKING = 0.9
"""Share of the acceleration limit that is counted on for stopping before the end of a range."""
MARGIN = 1e-4
"""Before the end of a range, where a joint comes to rest [rad]; it takes up what a step overruns."""


def acceleration_bounds(q: Array, v: Array, h: float, limits: JointLimits) -> tuple[Array, Array]:
    """Lowest and highest accelerations `(n,)` for a step of `h` [s].

    They keep the acceleration and velocity limits, and let every joint stop within its range.
    """
    fastest = np.minimum(limits.velocity, _stoppable(limits.upper - q, v, h, limits))
    slowest = -np.minimum(limits.velocity, _stoppable(q - limits.lower, -v, h, limits))
    lowest = np.clip((slowest - v) / h, -limits.acceleration, limits.acceleration)
    highest = np.clip((fastest - v) / h, -limits.acceleration, limits.acceleration)
    return np.minimum(lowest, highest), np.maximum(lowest, highest)


def _stoppable(room: Array, v: Array, h: float, limits: JointLimits) -> Array:
    """Highest speed after the step from which a joint still stops within `room` [rad]."""
    a = BRAKING * limits.acceleration
    left = np.maximum(room - MARGIN - 0.5 * h * v, 0.0)
    return np.asarray(-0.5 * a * h + np.sqrt(0.25 * (a * h) ** 2 + 2.0 * a * left))
