"""Way-points and speeds of the profile `thesis` (section 8.4)."""

from __future__ import annotations

from pydantic import Field, PositiveFloat

from pack_core.config import Config

Point = tuple[float, float, float]


class ThesisConfig(Config):
    safe_pick: Point = Field(default=(-2.5, 2.5, 2.0), description="over table A [m]")
    safe_table: Point = Field(default=(-0.5, 2.5, 2.0), description="over table B [m]")
    safe_pallet: Point = Field(default=(0.0, 0.5, 2.0), description="over the pallet [m]")
    above: PositiveFloat = Field(default=0.30, description="way-points over a goal [m]")
    step_back: PositiveFloat = Field(default=0.20, description="from a box on table B [m]")
    before_table: PositiveFloat = Field(default=0.10, description="over the place on table B [m]")
    final_height: PositiveFloat = Field(default=0.01, description="of the pre-deposit over the place [m]")
    standoff: PositiveFloat | None = Field(
        default=None, description="where an insertion begins, beside the place [m]; None: as Eq. 6.6 has it"
    )
    speed: PositiveFloat = Field(default=0.25, description="of lines [m/s]")
    acceleration: PositiveFloat = Field(default=2.5, description="of lines [m/s^2]")
