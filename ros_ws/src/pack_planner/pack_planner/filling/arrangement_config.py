"""Parameters of the arrangement of a list's objects in a container."""

from __future__ import annotations

from typing import ClassVar

from pydantic import Field, NonNegativeFloat, PositiveInt

from pack_core.config import NEXT_REQUEST, Changeable, Config


class ArrangementConfig(Config):
    """How many arrangements are tried, and how close objects may stand."""

    changeable: ClassVar[Changeable] = NEXT_REQUEST

    tries: PositiveInt = Field(default=400, description="arrangements that are tried")
    tries_again: PositiveInt = Field(default=40, description="and that are tried where one is known already")
    gap: NonNegativeFloat = Field(default=0.002, description="gap between objects [m]")
    wall_gap: NonNegativeFloat = Field(default=0.003, description="gap to the walls [m]")
    free_gap: NonNegativeFloat = Field(
        default=0.012, description="gap to everything where contact is to be avoided [m]"
    )
    object_worth: NonNegativeFloat = Field(
        default=0.1, description="share of the base that an object more is worth, whatever its size"
    )
    yielding: NonNegativeFloat = Field(
        default=0.006, description="overlap with what stands there by now at which a place is kept [m]"
    )
    shuffle: NonNegativeFloat = Field(
        default=0.8, description="how far tries depart from the largest-first order, as share of an area"
    )
