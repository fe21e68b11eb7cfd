"""Gears that give way."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field, NonNegativeFloat, PositiveFloat

from pack_core.config import Config

Six = Annotated[tuple[PositiveFloat, ...], Field(min_length=6, max_length=6)]


class Gears(Config):
    """The gears of six joints, between motors, which the controller measures, and links."""

    stiffness: Six
    """Of each, beyond its play [N m/rad]."""
    damping: Six
    """[N m s/rad]"""
    inertia: Six
    """Of the gear behind its spring [kg m^2]."""
    backlash_deg: NonNegativeFloat
    """Full play of each, seen at the joint."""
    stiffness_error: Annotated[float, Field(gt=-1.0)]
    """Of what the controller believes, as a share: it leads the motors by the load over this stiffness."""
