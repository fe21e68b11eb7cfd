"""Poses on the table: position and yaw."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from pack_core.rotations import Array, Pose, from_yaw, yaw_of

QUARTER = np.pi / 2
"""A quarter turn [rad]: a square block looks the same after it."""


@dataclass(frozen=True)
class PlanarPose:
    """X_WB of a body that stands on the table: position of its centre [m] and yaw [rad]."""

    x: float
    y: float
    yaw: float = 0.0

    @classmethod
    def of(cls, X_WB: Pose) -> PlanarPose:
        """The planar part of a pose."""
        return cls(float(X_WB.p[0]), float(X_WB.p[1]), yaw_of(X_WB.q))

    def pose(self, z: float) -> Pose:
        """X_WB with the body's centre at height `z` [m]."""
        return Pose(np.array([self.x, self.y, z]), from_yaw(self.yaw))

    @property
    def p(self) -> Array:
        """Position `(2,)` [m]."""
        return np.array([self.x, self.y])

    @property
    def row(self) -> tuple[float, float, float]:
        """The pose as x [m], y [m], yaw [rad]."""
        return self.x, self.y, self.yaw

    @property
    def is_finite(self) -> bool:
        """Neither NaN nor infinite."""
        return bool(np.isfinite(self.row).all())

    def moved(self, distance: float, direction: float) -> PlanarPose:
        """The same orientation, `distance` [m] further along `direction` [rad]."""
        return PlanarPose(
            self.x + distance * float(np.cos(direction)),
            self.y + distance * float(np.sin(direction)),
            self.yaw,
        )

    def distance_to(self, other: PlanarPose) -> float:
        """Between the centres [m]."""
        return float(np.hypot(self.x - other.x, self.y - other.y))


def wrapped(angle: npt.ArrayLike, period: float = 2 * np.pi) -> Array:
    """Angles [rad] brought into [-period / 2, period / 2)."""
    return np.asarray((np.asarray(angle, dtype=float) + period / 2) % period - period / 2)


def turn_between(a: PlanarPose, b: PlanarPose, symmetry: int = 1) -> float:
    """Smallest turn [rad] from a to b of a body that looks alike after every 1 / `symmetry` turn."""
    return float(wrapped(b.yaw - a.yaw, 2 * np.pi / symmetry))
