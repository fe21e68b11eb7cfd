"""Parameters that the placement planners share."""

from __future__ import annotations

from typing import ClassVar

from pydantic import Field, NonNegativeFloat, NonNegativeInt, PositiveFloat, PositiveInt

from pack_core.config import NEXT_REQUEST, Changeable, Config
from pack_planner.placement.approach_config import ApproachConfig


class PlacementConfig(Config):
    """Parameters of Algorithm 1, the paper's values by default."""

    changeable: ClassVar[Changeable] = NEXT_REQUEST

    samples: PositiveInt = Field(300, description="sampled poses S")
    steps: PositiveInt = Field(30, description="steps M in which overlaps must resolve")
    timestep: PositiveFloat = Field(0.006, description="step of the physics [s]")
    weights: tuple[NonNegativeFloat, NonNegativeFloat, NonNegativeFloat] = Field(
        (1.0, 1.0, 10.0), description="w_x, w_y, w_z on the objects' displacements"
    )
    beta: NonNegativeFloat = Field(1000.0, description="weight of lasting penetration [1/m]")
    resting_penetration: PositiveFloat = Field(
        0.001, description="depth [m] up to which two objects touch; what is deeper has not resolved"
    )
    threads: NonNegativeInt = Field(0, description="threads of the physics; 0: all cores")
    near_samples: PositiveInt = Field(40, description="poses that are tried about one that is wanted")
    near_deviation: tuple[PositiveFloat, PositiveFloat] = Field(
        (0.004, 0.03), description="standard deviation of these poses: position [m] and yaw [rad]"
    )
    near_weight: NonNegativeFloat = Field(
        3.0, description="cost of a distance from the one that is wanted, beside the displacements of others"
    )
    approach: ApproachConfig = ApproachConfig()
