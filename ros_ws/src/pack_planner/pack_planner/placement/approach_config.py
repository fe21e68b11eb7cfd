"""Parameters of the rehearsed entries."""

from __future__ import annotations

from pydantic import Field, NonNegativeFloat, NonNegativeInt, PositiveFloat, PositiveInt

from pack_core.config import Config


class ApproachConfig(Config):
    """Parameters of the rehearsals."""

    crowded: NonNegativeFloat = Field(
        0.5,
        description="covered share of the base from which on the first placement is rehearsed, too; "
        "one with obstacles all around always is",
    )
    likely: PositiveInt = Field(
        3, description="placements rehearsed in the first round, leaning over their obstacles"
    )
    rounds: NonNegativeInt = Field(8, description="most rounds of rehearsals; 0: no rehearsals")
    candidates: PositiveInt = Field(40, description="placements that are considered, the cheapest first")
    drawn: PositiveInt = Field(400, description="random entries drawn in a round while every entry fails")
    random: PositiveInt = Field(
        40, description="how many of them are rehearsed: those that begin most nearly over gaps"
    )
    fresh: PositiveInt = Field(
        3, description="new placements in a round beside variations of the best so far"
    )
    spacing: PositiveFloat = Field(0.01, description="least distance between candidates, seen from above [m]")
    variations: PositiveInt = Field(
        6, description="variations of the best placement so far in each further round"
    )
    deviation: tuple[PositiveFloat, PositiveFloat] = Field(
        (0.006, 0.1), description="standard deviation of variations: position [m] and yaw [rad]"
    )
    sides: PositiveInt = Field(8, description="directions in which the object may lean")
    finalists: PositiveInt = Field(
        6, description="best entries of a round that are rehearsed again, perturbed"
    )
    error: NonNegativeFloat = Field(0.006, description="perturbation of these rehearsals [m]")
