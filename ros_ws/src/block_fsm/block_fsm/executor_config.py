"""Parameters of the executor."""

from __future__ import annotations

from typing import ClassVar

from pydantic import Field, NonNegativeFloat, PositiveFloat, PositiveInt

from pack_core.config import NEXT_GOAL, Changeable, Config


class SpeedConfig(Config):
    """How fast the arm goes; what is carried slips a little in proportion to it."""

    travel: float = Field(default=0.6, gt=0, le=1, description="empty: share of the joint velocity limits")
    travel_acceleration: float = Field(
        default=0.6, gt=0, le=1, description="empty: share of the joint acceleration limits"
    )
    carry: PositiveFloat = Field(default=0.4, description="with a block in the hand [m/s]")
    carry_acceleration: PositiveFloat = Field(default=1.5, description="with a block in the hand [m/s^2]")
    descend: PositiveFloat = Field(default=0.25, description="down and up beside blocks [m/s]")
    touch: PositiveFloat = Field(default=0.05, description="where a block nears the table [m/s]")
    push: PositiveFloat = Field(default=0.05, description="of a push [m/s]")


class ToleranceConfig(Config):
    """What counts as being as predicted."""

    position: PositiveFloat = Field(default=0.002, description="of any block before an action [m]")
    angle_deg: PositiveFloat = Field(default=2.0, description="of any block before an action")
    push_along: PositiveFloat = Field(default=0.0005, description="after a push, along it [m]")
    push_lateral: PositiveFloat = Field(default=0.001, description="after a push, across it [m]")
    push_angle_deg: PositiveFloat = Field(default=1.0, description="after a push")
    bystander: PositiveFloat = Field(
        default=0.001, description="a block that was not to be moved has moved by more [m]"
    )


class ExecutorConfig(Config):
    """Parameters of the executor."""

    changeable: ClassVar[Changeable] = NEXT_GOAL

    hover: PositiveFloat = Field(default=0.130, description="height of the tips between actions [m]")
    carry_height: PositiveFloat = Field(default=0.110, description="height of the tips with a block [m]")
    release_height: PositiveFloat = Field(
        default=0.0004, description="of a block over the table when it is let go [m]"
    )
    back_off: PositiveFloat = Field(default=0.003, description="after a push, before going up [m]")
    grasp_squeeze: PositiveFloat = Field(
        default=0.010, description="how much narrower than the block the fingers are told to close [m]"
    )
    width_tolerance: PositiveFloat = Field(
        default=0.003,
        description="by which what the fingers hold may be wider or narrower than the block [m]; they press "
        "into it by up to 1 mm",
    )
    looks: PositiveInt = Field(default=3, description="pictures in a row in which a block may be unseen")
    grasps: PositiveInt = Field(default=3, description="failed grasps in a row that end the task")
    refusals: PositiveInt = Field(
        default=5, description="actions in a row that the arm cannot do which end the task"
    )
    spare_actions: PositiveInt = Field(
        default=20, description="beyond twice the first plan's actions, before there is no progress"
    )
    speed: SpeedConfig = SpeedConfig()
    tolerance: ToleranceConfig = ToleranceConfig()


class RequestTimeouts(Config):
    """How long things may take, on the simulated clock."""

    exposure_delay: NonNegativeFloat = Field(
        default=0.1, description="before a picture, for the arm to be still [s]"
    )
    picture: PositiveFloat = Field(default=10.0, description="from exposure to the poses [s]")
    plan: PositiveFloat = Field(default=60.0, description="for the planner to answer [s]")
    move: PositiveFloat = Field(default=30.0, description="of the arm [s]")
    jaw: PositiveFloat = Field(default=3.0, description="of the fingers [s]")
