"""Limits of an arm's joints."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from pack_core.rotations import Array

LONG_WAY = 0.02
"""Weight of the sum of all joints' times beside the longest one, when postures are compared."""
FLIP = 0.15
"""Penalty for a flip of the wrist [s]."""


@dataclass(frozen=True)
class JointLimits:
    """Names and published limits of n joints, each array `(n,)` and read-only.

    Attributes:
        names: as they appear in messages.
        lower: [rad].
        upper: [rad].
        velocity: [rad/s].
        acceleration: [rad/s^2].
        effort: [N m].
    """

    names: tuple[str, ...]
    lower: Array
    upper: Array
    velocity: Array
    acceleration: Array
    effort: Array

    def __post_init__(self) -> None:
        for field in ("lower", "upper", "velocity", "acceleration", "effort"):
            object.__setattr__(self, field, _frozen(getattr(self, field), len(self.names)))

    @property
    def middle(self) -> Array:
        """The middle of each joint's range `(n,)` [rad]."""
        return 0.5 * (self.lower + self.upper)

    def lifted(self) -> JointLimits:
        """The same joints with limits that nothing reaches."""
        many = np.ones(len(self.names))
        return replace(
            self, lower=-1e3 * many, upper=1e3 * many, velocity=1e2 * many, acceleration=1e5 * many,
            effort=1e8 * many,
        )  # fmt: skip

    def __len__(self) -> int:
        return len(self.names)


def step_times(steps: Array, velocity: Array, acceleration: Array) -> Array:
    """Time that each joint takes for a step from rest to rest, without limits of jerk [s].

    Args:
        steps: `(..., n)` [rad].
        velocity: limits `(n,)` [rad/s].
        acceleration: limits `(n,)` [rad/s^2].
    """
    way = np.abs(steps)
    # A trapezoid of speed takes d / v + v / a; a step too short to reach v takes 2 sqrt(d / a).
    is_long = way * acceleration > velocity**2
    return np.where(is_long, way / velocity + velocity / acceleration, 2.0 * np.sqrt(way / acceleration))


def step_effort(step: Array, velocity: Array, acceleration: Array, *, is_flip: bool) -> float:
    """What a step `(n,)` [rad] costs where postures are compared: its duration, plus penalties [s].

    They are for the way of the other joints, and for a flip of the wrist, on which the tool sweeps through a
    wide arc.
    """
    times = step_times(step, velocity, acceleration)
    return float(times.max() + LONG_WAY * times.sum() + FLIP * is_flip)


def _frozen(values: npt.ArrayLike, size: int) -> Array:
    array = np.array(values, dtype=float).reshape(size)
    array.setflags(write=False)
    return array
