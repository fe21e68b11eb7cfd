"""Factors on the weights of the cost, to try other ones without another file of weights."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from pack_core.config import Config

Factor = Annotated[float, Field(ge=0.0, le=10.0)]


class WeightFactors(Config):
    """A factor on each residual's weight, in all stages; 1 leaves it as the set of weights has it."""

    position: Factor = Field(default=1.0, description="on the weight of the distance to the target")
    upright: Factor = Field(default=1.0, description="on the weight of the held object's tilt")
    yaw: Factor = Field(default=1.0, description="on the weight of the turn about the vertical")
    force: Factor = Field(default=1.0, description="on the weight of the contact force")
    joint_limit: Factor = Field(default=1.0, description="on the weight of nearness to joint limits")
    joint_velocity: Factor = Field(default=1.0, description="on the weight of the joints' speeds")
    obstacle: Factor = Field(default=1.0, description="on the weight of nearness to other objects")
