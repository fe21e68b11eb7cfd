"""Gains of an arm's joint controller."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from pydantic import Field, NonNegativeFloat, PositiveFloat

from pack_core.config import Config
from pack_core.rotations import Array


class JointServoGains(Config):
    """A position loop on every joint, as stiff as its frequency says, with a slow integral."""

    inertia: Annotated[tuple[PositiveFloat, ...], Field(min_length=1)]
    """Of the joints near the middle of the workspace, for the gains [kg m^2]."""
    frequency: PositiveFloat
    """Natural frequency of the position loop [Hz]."""
    damping_ratio: PositiveFloat
    integral_rate: NonNegativeFloat
    """Of the position gain [1/s]."""
    integral_limit: NonNegativeFloat
    """Of the published effort."""
    stop_deceleration: PositiveFloat
    """Of the published acceleration, when no reference comes any more."""

    @property
    def stiffness(self) -> Array:
        """Position gains `(n,)` [N m/rad]."""
        return np.array(self.inertia) * (2 * np.pi * self.frequency) ** 2

    @property
    def damping(self) -> Array:
        """Velocity gains `(n,)` [N m s/rad]."""
        return np.array(self.inertia) * (4 * np.pi * self.frequency * self.damping_ratio)
