"""Parameters of the contact governor."""

from __future__ import annotations

from pydantic import Field, NonNegativeFloat, PositiveFloat, model_validator

from pack_core.config import Config


class GovernorConfig(Config):
    """Bounds while there is contact; they hold for the wrench that the driver exerts on the cup."""

    trigger: PositiveFloat = Field(
        default=4.0, description="external force that counts as contact [N]; .inf: the driver bounds nothing"
    )
    tare_time: PositiveFloat = Field(
        default=0.5, description="time constant of the bias estimate in free motion [s]"
    )
    bias: PositiveFloat = Field(default=3.0, description="largest bias that the sensor can have [N]")
    draw_back: PositiveFloat = Field(
        default=0.03, description="way back after which a contact must have ended [m]"
    )
    latch: NonNegativeFloat = Field(default=0.15, description="time for which a contact is remembered [s]")
    filter_time: PositiveFloat = Field(
        default=0.005, description="time constant of the filter of the measured force [s]"
    )
    force: PositiveFloat = Field(
        default=28.0, description="largest force of the driver sideways, and down [N]"
    )
    bending: PositiveFloat = Field(
        default=4.0, description="measured load on the cup from which the arm gives way [N m]"
    )
    bending_limit: PositiveFloat = Field(
        default=6.0, description="load at which the arm presses no more; beyond, it pulls back [N m]"
    )
    push: PositiveFloat = Field(
        default=25.0, description="largest push of the driver against the measured force [N]"
    )
    pull_out: PositiveFloat = Field(
        default=30.0, description="largest pull against a force that holds the object down [N]"
    )
    reflex: NonNegativeFloat = Field(
        default=3.0, description="by how much each newton measured beyond `push` or `pull_out` reduces it"
    )
    pull_back: NonNegativeFloat = Field(default=40.0, description="largest force away from the contact [N]")
    approach: PositiveFloat = Field(default=0.03, description="reference speed into the contact [m/s]")
    build_up: NonNegativeFloat = Field(
        default=0.3,
        description="by how much it grows each second vertically, while the cup rests there [m/s^2]",
    )

    @model_validator(mode="after")
    def _gives_way_before_its_limit(self) -> GovernorConfig:
        if self.bending >= self.bending_limit:
            raise ValueError(
                f"bending is {self.bending}; allowed: less than bending_limit, {self.bending_limit}"
            )
        return self
