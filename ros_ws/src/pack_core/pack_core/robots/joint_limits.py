"""Limits of an arm's joints."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from pack_core.rotations import Array


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


def _frozen(values: npt.ArrayLike, size: int) -> Array:
    array = np.array(values, dtype=float).reshape(size)
    array.setflags(write=False)
    return array
