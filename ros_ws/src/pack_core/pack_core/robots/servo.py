"""Gains of an arm's joint controller."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from pydantic import Field, NonNegativeFloat, PositiveFloat

from pack_core.config import Config
from pack_core.rotations import Array


class JointServoGains(Config):
    """A position loop on every joint, with gains from its natural frequency, and a slow integral.

    With the joint's inertia I and omega = 2 pi f: kp = I omega^2 and kd = 2 zeta I omega.
    """

    inertia: Annotated[tuple[PositiveFloat, ...], Field(min_length=1)]
    """Inertia at each joint near the middle of the workspace, from which the gains are computed [kg m^2]."""
    frequency: PositiveFloat
    """Natural frequency of the position loop [Hz]."""
    damping_ratio: PositiveFloat
    integral_rate: NonNegativeFloat
    """Integral gain as a share of the position gain [1/s]."""
    integral_limit: NonNegativeFloat
    """Largest torque of the integral as a share of the published effort."""
    stop_deceleration: PositiveFloat
    """Deceleration when references stop coming, as a share of the published acceleration."""

    @property
    def stiffness(self) -> Array:
        """Position gains `(n,)` [N m/rad]."""
        return np.array(self.inertia) * (2 * np.pi * self.frequency) ** 2

    @property
    def damping(self) -> Array:
        """Velocity gains `(n,)` [N m s/rad]."""
        return np.array(self.inertia) * (4 * np.pi * self.frequency * self.damping_ratio)
