"""Bounds of the joint accelerations within which every joint limit is kept."""

from __future__ import annotations

import numpy as np

from pack_core.robots.joint_properties import JointLimits
from pack_core.rotations import Array

BRAKING = 0.9
"""Share of the acceleration limit that is assumed for stopping before the end of a range."""
MARGIN = 1e-4
"""A joint is stopped this far before the end of its range [rad], so that a time step cannot overrun it."""


def acceleration_bounds(q: Array, v: Array, h: float, limits: JointLimits) -> tuple[Array, Array]:
    """Lowest and highest accelerations `(n,)` for a step of `h` [s].

    Between them the acceleration and velocity limits are kept, and every joint can still stop in its range.
    """
    fastest = np.minimum(limits.velocity, _stoppable(limits.upper - q, v, h, limits))
    slowest = -np.minimum(limits.velocity, _stoppable(q - limits.lower, -v, h, limits))
    lowest = np.clip((slowest - v) / h, -limits.acceleration, limits.acceleration)
    highest = np.clip((fastest - v) / h, -limits.acceleration, limits.acceleration)
    return np.minimum(lowest, highest), np.maximum(lowest, highest)


def _stoppable(room: Array, v: Array, h: float, limits: JointLimits) -> Array:
    """Highest speed w after the step from which a joint still stops within `room` [rad].

    The step itself covers h (v + w) / 2, stopping covers w^2 / (2 a): the result is the root of
    w^2 + a h w - 2 a left = 0, where `left` is the room less the part of the step that v covers.
    """
    a = BRAKING * limits.acceleration
    left = np.maximum(room - MARGIN - 0.5 * h * v, 0.0)
    return np.asarray(-0.5 * a * h + np.sqrt(0.25 * (a * h) ** 2 + 2.0 * a * left))
