"""Parameters of the contact governor."""

from __future__ import annotations

from pydantic import Field, NonNegativeFloat, PositiveFloat, model_validator

from pack_core.config import Config


class GovernorConfig(Config):
    """Bounds while there is contact; wrenches are those of the driver on the cup."""

    trigger: PositiveFloat = Field(default=4.0, description="external force that counts as contact [N]")
    tare_time: PositiveFloat = Field(
        default=0.5, description="in which free motion shows the sensor's bias [s]"
    )
    bias: PositiveFloat = Field(default=3.0, description="largest bias that the sensor can have [N]")
    draw_back: PositiveFloat = Field(
        default=0.03, description="way back from a contact that must have ended it [m]"
    )
    latch: NonNegativeFloat = Field(default=0.15, description="for which contact is remembered [s]")
    filter_time: PositiveFloat = Field(default=0.005, description="of the measured force [s]")
    force: PositiveFloat = Field(default=20.0, description="sideways, and down [N]")
    bending: PositiveFloat = Field(
        default=0.9, description="measured load on the cup from which the arm gives way [N m]"
    )
    bending_limit: PositiveFloat = Field(default=1.4, description="at which it gives way wholly [N m]")
    push: PositiveFloat = Field(default=18.0, description="against the measured force [N]")
    reflex: NonNegativeFloat = Field(default=3.0, description="less push for every newton beyond `push`")
    pull_back: NonNegativeFloat = Field(
        default=40.0, description="at most, against the direction of push [N]"
    )
    approach: PositiveFloat = Field(default=0.03, description="reference speed into the contact [m/s]")

    @model_validator(mode="after")
    def _gives_way_before_its_limit(self) -> GovernorConfig:
        if self.bending >= self.bending_limit:
            raise ValueError(
                f"bending is {self.bending}; allowed: less than bending_limit, {self.bending_limit}"
            )
        return self
