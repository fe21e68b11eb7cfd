"""Parameters of a goal: when it ends, and those of its stages."""

from __future__ import annotations

import math

from pydantic import Field, NonNegativeFloat, PositiveFloat, PositiveInt

from pack_core.config import Config
from pack_mpc.look import LookConfig
from pack_mpc.stages import StageConfig


class TaskConfig(Config):
    """Exit conditions of a goal."""

    timeout: PositiveFloat = Field(default=20.0, description="simulated time that a goal may take [s]")
    force_stop: PositiveFloat = Field(default=math.inf, description="external force that ends the goal [N]")
    avoid_radius: PositiveFloat = Field(
        default=0.02, description="distance that new placements keep from those tried [m]"
    )
    patience: PositiveFloat = Field(
        default=0.5,
        description="time at a halt that relieves the force weight once, as a failed attempt does [s]",
    )
    placement_tries: PositiveInt = Field(
        default=3, description="refused placements in a row that end the goal"
    )
    landing_reach: NonNegativeFloat = Field(
        default=0.0,
        description="an object this near to a placement may be landed on: the way down is slow [m]",
    )
    look: LookConfig = LookConfig()
    stages: StageConfig = StageConfig()
