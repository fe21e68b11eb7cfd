"""A small rigid displacement of a thing that stands still, from where the configuration has it."""

from __future__ import annotations

from typing import Annotated

import numpy as np
import numpy.typing as npt
from pydantic import Field

from pack_core.config import Config
from pack_core.rotations import Array, Pose, exp, log

Vector = Annotated[tuple[float, float, float], Field(description="along x, y and z of the world")]


class Displacement(Config):
    """How far a thing stands from its nominal place: it is turned about its own middle, then shifted."""

    shift: Vector = (0.0, 0.0, 0.0)
    """Displacement of its middle [m]."""
    turn: Vector = (0.0, 0.0, 0.0)
    """Rotation vector about its middle [rad]."""

    @property
    def is_zero(self) -> bool:
        """Whether the thing stands at its nominal place."""
        return not any(self.shift) and not any(self.turn)

    @classmethod
    def of(cls, vector: npt.ArrayLike) -> Displacement:
        """The displacement with shift and turn in one vector `(6,)` [m, rad]."""
        x, y, z, a, b, c = (float(value) for value in np.asarray(vector, dtype=float))
        return cls(shift=(x, y, z), turn=(a, b, c))

    @classmethod
    def between(cls, nominal: Pose, displaced: Pose, middle: npt.ArrayLike) -> Displacement:
        """The displacement that takes a frame of the thing from one pose to another, middle `(3,)` [m]."""
        moved, p = displaced @ nominal.inverse(), np.asarray(middle, dtype=float)
        return cls.of([*(moved.apply(p) - p), *log(moved.q)])

    @property
    def vector(self) -> Array:
        """Shift and turn `(6,)` [m, rad]."""
        return np.array([*self.shift, *self.turn])

    def about(self, middle: npt.ArrayLike) -> Pose:
        """The transform that takes nominal points of the world to the displaced ones, middle `(3,)` [m]."""
        p = np.asarray(middle, dtype=float)
        return Pose(p + np.array(self.shift), exp(self.turn)) @ Pose(-p)

    def applied(self, X_WF: Pose, middle: npt.ArrayLike) -> Pose:
        """Where a frame F that is fixed to the thing is; exactly X_WF where nothing is displaced."""
        return X_WF if self.is_zero else self.about(middle) @ X_WF


NOWHERE = Displacement()
"""Of a thing that stands where it should."""
