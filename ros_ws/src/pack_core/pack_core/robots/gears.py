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
