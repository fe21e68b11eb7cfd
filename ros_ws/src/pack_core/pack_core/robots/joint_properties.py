"""What is known of an arm's joints: published limits, gains of their servos, and gears that give."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np
import numpy.typing as npt
from pydantic import Field, NonNegativeFloat, PositiveFloat

from pack_core.config import Config
from pack_core.rotations import Array

LONG_WAY = 0.02
"""Weight of the sum of all joints' times beside the longest one, when postures are compared."""
FLIP = 0.15
"""Penalty for a flip of the wrist [s]."""
Six = Annotated[tuple[PositiveFloat, ...], Field(min_length=6, max_length=6)]


TURN = 2.0 * np.pi
"""After a whole turn a joint's link is where it was [rad]."""


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

    def unwound(self, q: Array) -> Array:
        """Joint positions `(n,)` [rad], those beyond their range turned back by whole turns."""
        is_beyond = (q < self.lower) | (q > self.upper)
        return np.asarray(q - np.where(is_beyond, TURN * np.round(q / TURN), 0.0))

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


class Gears(Config):
    """The gears of six joints, between motors, which the controller measures, and links."""

    stiffness: Six
    """Stiffness of each gear beyond its play [N m/rad]."""
    damping: Six
    """Damping of each gear [N m s/rad]."""
    inertia: Six
    """Inertia of each gear behind its spring [kg m^2]."""
    backlash_deg: NonNegativeFloat
    """Full play of each gear, seen at the joint [deg]."""
    stiffness_error: Annotated[float, Field(gt=-1.0)]
    """Relative error of the stiffness that the controller assumes when it compensates the deflection."""
    reports_links: bool = False
    """Whether the controller reports the motors' angles less the deflection that it assumes."""

    @property
    def assumed(self) -> GearCompensation:
        """What the controller assumes when nobody has measured the gears."""
        stiffness = 1.0 + self.stiffness_error
        k_1, k_2, k_3, k_4, k_5, k_6 = (stiffness * k for k in self.stiffness)
        return GearCompensation(stiffness=(k_1, k_2, k_3, k_4, k_5, k_6))


class GearCompensation(Config):
    """What an arm's controller assumes of its gears."""

    stiffness: Six
    """Of each gear [N m/rad]."""
    backlash_deg: NonNegativeFloat = 0.0
    """Full play that is compensated in the direction of the load [deg]."""
    full_load: PositiveFloat = 0.02
    """Load above which a gear is taken to lie at one side of its play, as a share of the published effort;
    the compensation fades in up to there."""
