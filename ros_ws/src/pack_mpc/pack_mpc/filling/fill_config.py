"""Parameters of a fill job: how the arm picks up, sets down and lets go."""

from __future__ import annotations

from typing import ClassVar

from pydantic import Field, NonNegativeFloat, PositiveFloat

from pack_core.config import NEXT_GOAL, Changeable, Config
from pack_mpc.session import SessionConfig


class FillConfig(Config):
    """Speeds, heights and forces of the motions between two packing goals."""

    changeable: ClassVar[Changeable] = NEXT_GOAL

    speed: PositiveFloat = Field(default=0.9, description="largest speed of the empty cup [m/s]")
    acceleration: PositiveFloat = Field(default=4.0, description="largest acceleration of the cup [m/s^2]")
    corner: PositiveFloat = Field(
        default=0.1, description="way on either side of a corner, over everything, on which it is rounded [m]"
    )
    corner_speed: PositiveFloat = Field(default=0.35, description="largest speed of the cup there [m/s]")
    carry_speed: PositiveFloat = Field(
        default=0.4, description="largest speed when an object is put aside [m/s]"
    )
    touch_speed: PositiveFloat = Field(default=0.045, description="speed towards an object's top [m/s]")
    touch_acceleration: PositiveFloat = Field(
        default=0.3, description="where a contact is awaited: a start must not feel like one [m/s^2]"
    )
    clearance: PositiveFloat = Field(
        default=0.03, description="gap over what the arm passes, and instead of `task.stages.clearance` [m]"
    )
    approach: PositiveFloat = Field(
        default=0.012, description="height over an object's top from which the cup comes down slowly [m]"
    )
    centring: PositiveFloat = Field(
        default=0.002, description="distance of the cup from an object's middle at which it comes down [m]"
    )
    hand_over_reach: PositiveFloat = Field(
        default=0.2, description="distance from the hand-over place within which the cup is in its way [m]"
    )
    overshoot: PositiveFloat = Field(
        default=0.012, description="way beyond the expected contact before it counts as missed [m]"
    )
    touch_force: PositiveFloat = Field(default=4.0, description="change of force that tells a contact [N]")
    lift: PositiveFloat = Field(default=0.02, description="first way up with a gripped object [m]")
    grip_tries: int = Field(default=2, ge=1, description="how often a grip is tried")
    sight_time: PositiveFloat = Field(
        default=2.0, description="longest wait until the cameras have seen an object [s]"
    )
    first_sight_time: PositiveFloat = Field(
        default=0.15, description="wait for the cameras before the cup goes where the object is announced [s]"
    )
    calm_time: PositiveFloat = Field(
        default=0.15, description="wait after a goal until the arm is at rest and forces are steady [s]"
    )
    shift: PositiveFloat = Field(
        default=0.015, description="longest way aside with which an object is brought to its place [m]"
    )
    set_down_speed: PositiveFloat = Field(
        default=0.03, description="speed at which an object is brought to its place and down [m/s]"
    )
    settle: PositiveFloat = Field(
        default=0.003, description="way beyond the base on which an object is set down slowly [m]"
    )
    press_force: PositiveFloat = Field(
        default=12.0, description="change of force at which this ends: it stands, or something resists [N]"
    )
    standing: PositiveFloat = Field(
        default=0.002, description="height of an object's lower end that counts as standing [m]"
    )
    landing_reach: NonNegativeFloat = Field(
        default=0.015, description="`task.landing_reach` of the job's packing goals [m]"
    )
    pre_pack_distance: PositiveFloat = Field(
        default=0.008, description="`task.stages.pre_pack_distance` of the job's packing goals [m]"
    )
    pack_tries: int = Field(
        default=2, ge=1, description="how often an object is packed that does not stand afterwards"
    )
    release_height: PositiveFloat = Field(
        default=0.012, description="largest height of the lower end from which an object is let go [m]"
    )
    release_tilt_deg: PositiveFloat = Field(
        default=12.0, description="largest tilt at which an object is let go: it leans safely [deg]"
    )
    aside_reach: PositiveFloat = Field(
        default=0.05, description="distance from the hand-over place within which an object is put aside [m]"
    )
    draws: int = Field(
        default=4, ge=0, description="how often an object is drawn nearer that the arm cannot raise"
    )
    draw: PositiveFloat = Field(default=0.04, description="by how much each time [m]")
    draw_speed: PositiveFloat = Field(default=0.06, description="speed at which it is drawn nearer [m/s]")
    retreat_force: PositiveFloat = Field(
        default=15.0, description="change of force that tells that the cup drags something [N]"
    )
    rest_speed: PositiveFloat = Field(default=0.02, description="speed below which an object rests [m/s]")


class FillSessionConfig(SessionConfig):
    """Parameters of a fill job and of the packing goals in it."""

    fill: FillConfig = FillConfig()

    def of_goals(self) -> SessionConfig:
        """The parameters of the job's packing goals."""
        fill = self.fill
        stages = self.task.stages.model_copy(
            update={"pre_pack_distance": fill.pre_pack_distance, "clearance": fill.clearance}
        )
        task = self.task.model_copy(update={"landing_reach": fill.landing_reach, "stages": stages})
        return self.model_copy(update={"task": task})
