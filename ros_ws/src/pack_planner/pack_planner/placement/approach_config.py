"""Parameters of the rehearsed entries."""

from __future__ import annotations

from pydantic import Field, NonNegativeFloat, NonNegativeInt, PositiveFloat, PositiveInt

from pack_core.config import Config


class ApproachConfig(Config):
    """Parameters of the rehearsals."""

    crowded: NonNegativeFloat = Field(
        0.5, description="covered share of the base from which on the first placement is rehearsed, too"
    )
    likely: PositiveInt = Field(3, description="placements rehearsed before, over their obstacles")
    rounds: NonNegativeInt = Field(
        8, description="of rehearsals, until an entry is good; half of them while all fail; 0: none at all"
    )
    candidates: PositiveInt = Field(5, description="placements a round, the cheapest first")
    fresh: PositiveInt = Field(3, description="placements a round beside variations of the best so far")
    spacing: PositiveFloat = Field(0.01, description="between candidates, seen from above [m]")
    variations: PositiveInt = Field(6, description="of the best placement so far, in each further round")
    deviation: tuple[PositiveFloat, PositiveFloat] = Field(
        (0.006, 0.1), description="of variations, standard: position [m] and yaw [rad]"
    )
    sides: PositiveInt = Field(8, description="to which the object may lean")
    finalists: PositiveInt = Field(6, description="entries a round that are rehearsed again, off their way")
    error: NonNegativeFloat = Field(0.006, description="how far off [m]")

    @property
    def tried(self) -> int:
        """How many placements are rehearsed at most."""
        return max(self.likely, self.rounds * self.candidates)
