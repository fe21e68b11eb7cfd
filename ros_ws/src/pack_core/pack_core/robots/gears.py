"""Parameters of elastic gears with play."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field, NonNegativeFloat, PositiveFloat

from pack_core.config import Config

Six = Annotated[tuple[PositiveFloat, ...], Field(min_length=6, max_length=6)]


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
