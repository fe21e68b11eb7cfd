"""Parameters of the palletizing machine, each part of it in a section of its own."""

from __future__ import annotations

from typing import ClassVar, Self

from pydantic import Field, NonNegativeFloat, PositiveFloat, model_validator

from pack_core.config import NEXT_GOAL, Changeable, Config
from pack_perception.scans.comparison import ScanTolerances

Point = tuple[float, float, float]
Range = tuple[PositiveFloat, PositiveFloat]


class ToolPoseConfig(Config):
    """Distances between boxes, pad and tables."""

    pad_gap: NonNegativeFloat = Field(default=0.001, description="pad over the face when it grips [m]")
    drop: NonNegativeFloat = Field(default=0.002, description="box over what it is put on when let go [m]")
    overhang: NonNegativeFloat = Field(
        default=0.02, description="gripped face before the table's edge when a box is stood up [m]"
    )
    overhang_margin: NonNegativeFloat = Field(
        default=0.02, description="of the box's middle behind the edge then, at least [m]"
    )
    inset: PositiveFloat = Field(default=0.08, description="box from the table's corner along the edge [m]")


class BlendedConfig(Config):
    """Speeds and distances of blended moves."""

    lift: Range = Field(default=(0.1, 0.7), description="straight up from a stop, shortest and longest [m]")
    hover: Range = Field(default=(0.1, 1.0), description="straight down to a stop, shortest and longest [m]")
    step_back: Range = Field(default=(0.13, 0.40), description="from a box on table B [m]")
    speed: PositiveFloat = Field(default=1.0, description="on these lines, at most [m/s]")
    acceleration: PositiveFloat = Field(default=2.5, description="on these lines, at most [m/s^2]")
    slow_length: NonNegativeFloat = Field(
        default=0.1, description="from where the gripper acts, in which lines are slow [m]"
    )
    slow_speed: PositiveFloat = Field(default=0.24, description="of the tool on them there, at most [m/s]")
    pass_speed: PositiveFloat = Field(
        default=0.8, description="where lines are left for a joint move, or the other way round [m/s]"
    )
    final_height: PositiveFloat = Field(default=0.012, description="last segment before a box is let go [m]")
    final_speed: PositiveFloat = Field(default=0.12, description="on it [m/s]")
    standoff: PositiveFloat = Field(default=0.02, description="beside the place, where an insertion begins")
    corner: PositiveFloat = Field(default=0.008, description="cut off where lines meet at an angle [m]")
    safe: Point = Field(
        default=(-0.4, 1.5, 2.0),
        description="where to wait for a box, and where the arm ends: beside the pallet, which its scanner "
        "sees then [m]",
    )
    heavy: PositiveFloat = Field(
        default=2.5, description="mass times height from which a box is turned gently [kg m]"
    )
    gentle: PositiveFloat = Field(
        default=0.6, le=1.0, description="share of the joint accelerations when a heavy box is turned"
    )


class ThesisConfig(Config):
    """Way-points and speeds of the profile `thesis` (section 8.4)."""

    safe_pick: Point = Field(default=(-2.5, 2.5, 2.0), description="over table A [m]")
    safe_table: Point = Field(default=(-0.5, 2.5, 2.0), description="over table B [m]")
    safe_pallet: Point = Field(default=(0.0, 0.5, 2.0), description="over the pallet [m]")
    above: PositiveFloat = Field(default=0.30, description="way-points over a goal [m]")
    step_back: PositiveFloat = Field(default=0.20, description="from a box on table B [m]")
    before_table: PositiveFloat = Field(default=0.10, description="over the place on table B [m]")
    final_height: PositiveFloat = Field(default=0.01, description="of the pre-deposit over the place [m]")
    is_planned: bool = Field(
        default=True,
        description="whether lines are straight and moves are clear, or the motion is sent the goal alone",
    )
    speed: PositiveFloat = Field(default=0.25, description="of lines [m/s]")
    acceleration: PositiveFloat = Field(default=2.5, description="of lines [m/s^2]")


class FeederConfig(Config):
    """When the next box comes and is looked at."""

    clear: PositiveFloat = Field(
        default=0.3,
        description="distance of arm and carried box from table A, seen from above, from which on the next "
        "box is sent for [m]",
    )
    settle: NonNegativeFloat = Field(
        default=0.3, description="time from a box's arrival to the picture, so that the box is at rest [s]"
    )
    patience: PositiveFloat = Field(
        default=10.0,
        description="longest time until a box arrives, and until the camera answers, which draws by "
        "software beside other work [s]",
    )
    linger: NonNegativeFloat = Field(
        default=1.0,
        description="longest time that the arm stays where it let a box go until the next one is found, if "
        "that is about to happen [s]",
    )


class SecondLookConfig(Config):
    """When the second picture is taken, and what counts as a change."""

    distance: NonNegativeFloat = Field(
        default=1.1,
        description="of the tool from the middle of table A, seen from above, at which it is taken on the "
        "way to the box; 0: never. From 0.8 m on the arm covers the table [m]",
    )
    position: PositiveFloat = Field(default=0.003, description="by which a box has moved if by more [m]")
    angle_deg: PositiveFloat = Field(default=0.6, description="by which a box has turned if by more")
    patience: PositiveFloat = Field(default=10.0, description="longest time until the camera answers [s]")


class SmallMoveConfig(Config):
    """By how much a box on a pallet of a shift may be found elsewhere and is known to stand there then."""

    shift: PositiveFloat = Field(default=0.03, description="by which a box may have been moved [m]")
    turn_deg: PositiveFloat = Field(default=2.0, description="by which it may have been turned [deg]")


class ScanConfig(Config):
    """When the pallet and table B are scanned, and what counts as a change."""

    period: NonNegativeFloat = Field(
        default=0.2, description="between two scans while the arm comes near or leaves; 0: never [s]"
    )
    near: PositiveFloat = Field(
        default=0.5,
        description="distance of arm and carried box from a place, seen from above, within which it is "
        "scanned; while they are farther away nothing depends on it [m]",
    )
    clear: PositiveFloat = Field(
        default=0.15, description="distance from which on a scan is asked for: the arm moves meanwhile [m]"
    )
    hides: PositiveFloat = Field(
        default=0.1, description="distance below which they may hide something of the place [m]"
    )
    patience: PositiveFloat = Field(default=5.0, description="longest time until a scanner answers [s]")
    tolerances: ScanTolerances = ScanTolerances()
    small: SmallMoveConfig = SmallMoveConfig()

    @model_validator(mode="after")
    def _leaves_room_to_look(self) -> Self:
        if not self.hides <= self.clear < self.near:
            raise ValueError(
                f"hides, clear and near are {self.hides}, {self.clear} and {self.near} m; allowed: "
                "hides <= clear < near, or nothing is ever scanned"
            )
        return self


class WeighingConfig(Config):
    """How a box in the hand is weighed by the torques of the arm, and what counts as another weight."""

    window: NonNegativeFloat = Field(
        default=0.12, description="at even speed after each grip, over which it is weighed; 0: never [s]"
    )
    tolerance: PositiveFloat = Field(
        default=0.5,
        description="by which it may differ from what the order says, whatever that is; 1 if gears give [kg]",
    )
    share: NonNegativeFloat = Field(default=0.1, description="and by which share of that beyond it")


class MoverConfig(Config):
    """How long the machine waits for the motion, and until when before the gripper acts."""

    answer_time: PositiveFloat = Field(
        default=10.0, description="longest time until the motion accepts or refuses a target [s]"
    )
    settling_time: PositiveFloat = Field(
        default=2.0, description="longest time from the end of a motion until its target is confirmed [s]"
    )
    rest_speed: PositiveFloat = Field(
        default=0.003,
        description="the gripper acts once the tool is slower: a box in it is pressed by an arm that still "
        "moves against what the box stands on [m/s]",
    )
    rest_time: NonNegativeFloat = Field(
        default=0.5, description="longest time that the gripper waits for that [s]"
    )


class PalletizerConfig(Config):
    """Parameters of the machine."""

    changeable: ClassVar[Changeable] = NEXT_GOAL

    profile: str = Field(default="blended", description="thesis or blended")
    tries: int = Field(default=3, ge=1, description="for each kind of fault and box")
    dwell: NonNegativeFloat = Field(default=0.3, description="for the vacuum to build up or break down [s]")
    grip_patience: PositiveFloat = Field(default=2.0, description="for the gripper to close or open [s]")
    poses: ToolPoseConfig = ToolPoseConfig()
    blended: BlendedConfig = BlendedConfig()
    thesis: ThesisConfig = ThesisConfig()
    feeder: FeederConfig = FeederConfig()
    second_look: SecondLookConfig = SecondLookConfig()
    scans: ScanConfig = ScanConfig()
    weighing: WeighingConfig = WeighingConfig()
    mover: MoverConfig = MoverConfig()
