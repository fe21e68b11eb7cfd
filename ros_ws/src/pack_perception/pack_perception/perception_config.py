"""Parameters of perception by markers and by depth images, apart from the code that looks at depth images."""

from __future__ import annotations

from enum import Enum

from pydantic import Field, PositiveFloat, PositiveInt

from pack_core.config import Config
from pack_perception.mocap.physics_estimator import EstimatorConfig


class RegistrationConfig(Config):
    """How cameras are compared with the container, and how far off one may be."""

    search: PositiveFloat = Field(
        default=0.02, description="between the places, three each way, at which a fit begins [m]"
    )
    every: PositiveInt = Field(default=4, description="every many points one is used to choose among them")
    reaches: tuple[PositiveFloat, ...] = Field(
        default=(0.03, 0.015, 0.01, 0.006, 0.006, 0.006),
        min_length=3,
        description="farthest that a point is from a face of the container, by step of a fit [m]",
    )
    scale: PositiveFloat = Field(default=0.002, description="deviation from which a point counts less [m]")
    few: PositiveInt = Field(default=300, description="fewer points on walls say nothing")
    shift: PositiveFloat = Field(
        default=0.005, description="most that a camera may be off at the container [m]"
    )
    turn_deg: PositiveFloat = Field(default=0.5, description="most that it may be turned [deg]")


class HeightMapConfig(Config):
    """How heights become regions."""

    cell: PositiveFloat = Field(default=0.0025, description="edge of a cell of the map of heights [m]")
    flier: PositiveFloat = Field(
        default=0.006,
        description="a cell's highest point counts if the next one is at most this far below [m]",
    )
    floor: PositiveFloat = Field(default=0.015, description="what is lower is the container's base [m]")
    jump: PositiveFloat = Field(default=0.0025, description="step between cells at which a top ends [m]")
    slope: PositiveFloat = Field(default=0.028, description="step down to which a round top goes on [m]")
    flat: PositiveFloat = Field(
        default=0.002, description="a top whose heights spread by less than this is flat [m]"
    )
    min_area: PositiveFloat = Field(default=0.0004, description="smallest region that is an object [m^2]")
    notch: PositiveFloat = Field(
        default=0.004,
        description="depth of two notches in an outline at which a region may be two objects [m]",
    )


class ShapeFitConfig(Config):
    """How shapes are fitted and chosen."""

    side: PositiveFloat = Field(default=0.006, description="farthest that a side's point is from it [m]")
    below: PositiveFloat = Field(default=0.008, description="sides begin so far below the top [m]")
    close: PositiveFloat = Field(
        default=0.0025, description="farthest that most points are off a round surface that explains them [m]"
    )
    few: PositiveInt = Field(default=30, description="fewer points of a side are not used")
    top_deviation: PositiveFloat = Field(default=0.0015, description="of an edge seen from its top [m]")
    density: PositiveFloat = Field(default=600.0, description="of every object [kg/m^3]")
    corners: PositiveInt = Field(default=60, description="most corners of a hull")


class SpreadConfig(Config):
    """Standard deviations of a kind of shape where all of it was seen; the camera's noise decides them."""

    end: PositiveFloat = Field(description="standard deviation of an end of its outline [m]")
    height: PositiveFloat = Field(description="standard deviation of its height [m]")
    turn: PositiveFloat = Field(
        default=1.0, description="that of its heading, in parts of what its two long sides tell"
    )


class SpreadsConfig(Config):
    """The same by kind of shape, as looks of the seeds for tuning have them."""

    box: SpreadConfig = SpreadConfig(end=0.0008, height=0.00025, turn=0.6)
    cylinder: SpreadConfig = SpreadConfig(end=0.001, height=0.00025)
    capsule: SpreadConfig = SpreadConfig(end=0.0006, height=0.00025)
    mesh: SpreadConfig = SpreadConfig(end=0.0018, height=0.0009)


class DepthLookConfig(Config):
    """How a look finds objects."""

    heights: HeightMapConfig = HeightMapConfig()
    shapes: ShapeFitConfig = ShapeFitConfig()
    gain: float = Field(
        default=0.01,
        ge=0,
        description="by which two parts must overlap better with a region to be two objects",
    )
    good: float = Field(default=0.985, gt=0, le=1, description="overlap from which a region is one object")
    on_wall: PositiveFloat = Field(
        default=0.003, description="what is this near to the container's base or walls is a part of them [m]"
    )
    behind: PositiveFloat = Field(
        default=0.005,
        description="a pixel that measured so much more than the way to a point saw through it [m]",
    )
    spreads: SpreadsConfig = SpreadsConfig()
    open_end: PositiveFloat = Field(
        default=0.3, description="deviation of an end for each metre that the object may go on unseen [m/m]"
    )


class SurfaceFitConfig(Config):
    """How poses are fitted to points."""

    reach: PositiveFloat = Field(default=0.012, description="farthest that a point is from its surface [m]")
    scale: PositiveFloat = Field(default=0.0015, description="deviation from which a point counts less [m]")
    alike: PositiveInt = Field(
        default=120, description="points beyond so many bring nothing new: errors are alike"
    )
    few: PositiveInt = Field(default=30, description="fewer points give no pose")
    iterations: PositiveInt = Field(default=4, description="steps of a fit")
    position: PositiveFloat = Field(default=0.004, description="deviation of an expected position [m]")
    angle: PositiveFloat = Field(default=0.04, description="deviation of an expected orientation [rad]")


class LookAgainConfig(Config):
    """When what nobody described is looked at again, and what is then believed."""

    period: PositiveFloat = Field(
        default=0.5,
        description="time between two looks, where objects have moved [s]; .inf: none but the first",
    )
    moved: PositiveFloat = Field(
        default=0.005, description="an object that moved farther lets others be seen that it hid [m]"
    )
    surer: float = Field(
        default=0.7, gt=0, lt=1,
        description="a shape takes the place of another if its deviations are less than this share of theirs",
    )  # fmt: skip
    sure: PositiveFloat = Field(
        default=0.003, description="a shape whose lengths are surer than this stays as it is [m]"
    )
    tilt_deg: PositiveFloat = Field(
        default=2.0, description="what leans farther is not looked at: shapes stand upright on the base [deg]"
    )


class HeldFitConfig(Config):
    """How the object on the cup is measured before a goal."""

    reach: PositiveFloat = Field(
        default=0.15, description="farthest that its sides are from the cup's axis [m]"
    )
    few: PositiveInt = Field(default=40, description="fewer points in 5 mm of its height are none of it")
    most: PositiveInt = Field(default=2000, description="points of its sides that a shape is fitted to")
    close: PositiveFloat = Field(
        default=0.0016,
        description="farthest that most points are off a box or a cylinder; else it is a hull [m]",
    )
    end: PositiveFloat = Field(default=0.0002, description="standard deviation of a side's place [m]")
    below: PositiveFloat = Field(default=0.0004, description="standard deviation of its lower end [m]")
    hull_end: PositiveFloat = Field(default=0.0012, description="standard deviation of a side of a hull [m]")
    hull_below: PositiveFloat = Field(
        default=0.004,
        description="of a hull's lower end, whose edge may be round, so that nobody sees it [m]",
    )


class Objects(Enum):
    """What is known of the objects in the container before a look."""

    DESCRIBED = "described"
    """Shapes, sizes and masses; not their poses."""
    UNKNOWN = "unknown"
    """Nothing, not even their number."""


class DepthConfig(Config):
    """Perception by depth images."""

    objects: Objects = Field(default=Objects.DESCRIBED, description="what is known of the objects")
    registration: RegistrationConfig = RegistrationConfig()
    look: DepthLookConfig = DepthLookConfig()
    fit: SurfaceFitConfig = SurfaceFitConfig()
    held: HeldFitConfig = HeldFitConfig()
    again: LookAgainConfig = LookAgainConfig()
    every: PositiveInt = Field(default=3, description="every many pixels of a row or column one is tracked")


class PerceptionConfig(EstimatorConfig):
    """Parameters of perception, by markers or by depth images."""

    depth: DepthConfig = DepthConfig()
