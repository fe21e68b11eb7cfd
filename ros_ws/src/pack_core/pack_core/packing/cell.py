"""Physical facts of the packing cell: `config/cells/packing.yaml`."""

from __future__ import annotations

from enum import Enum
from functools import cache
from typing import Annotated

import numpy as np
from pydantic import Field, PositiveFloat, model_validator

from pack_core.config import Config, load_values, merged, parse_values, validate_config
from pack_core.packing.depth import DepthCameras, Point
from pack_core.packing.scene import Scene
from pack_core.packing.scene_item import SceneItem
from pack_core.paths import config_path
from pack_core.robots.arm_drive import ArmDrive
from pack_core.robots.pump import Pump
from pack_core.rotations import Pose, from_yaw
from pack_core.text.explanation import Layer
from pack_core.text.limits import Share


class Suction(Config):
    """Loads above which the cup lets go: pull [N], shear [N], bending moment [N m]; `.inf` disables one."""

    pull: PositiveFloat
    shear: PositiveFloat
    moment: PositiveFloat


class Tip(Config):
    """Compliance of the cup, between the pump's stem and what it holds.

    Attributes:
        lateral: stiffness perpendicular to the cup's axis [N/m].
        axial: stiffness along the cup's axis [N/m].
        bending: rotational stiffness about the two axes perpendicular to the cup's axis [N m/rad].
        twist: rotational stiffness about the cup's axis [N m/rad].
        damping_time: ratio of damping to stiffness, the same in every direction [s].
    """

    lateral: PositiveFloat
    axial: PositiveFloat
    bending: PositiveFloat
    twist: PositiveFloat
    damping_time: PositiveFloat

    @property
    def stiffness(self) -> tuple[float, ...]:
        """Along the axes x, y and z of an object that hangs upright [N/m], then about them [N m/rad]."""
        return self.lateral, self.lateral, self.axial, self.bending, self.bending, self.twist


class PushLimits(Config):
    """How hard the arm may push with what it holds; rehearsals of entries push as hard.

    Attributes:
        force: largest force along each axis of the world [N].
        moment: largest moment about each of them [N m].
    """

    force: PositiveFloat
    moment: PositiveFloat


class MocapCameras(Config):
    """The motion capture system.

    Attributes:
        cameras: positions of the cameras in the world [m].
        target: the point that all cameras look at [m].
        half_angle_deg: half the opening angle of each camera's conical field of view [deg].
        has_side_markers: whether objects carry markers on two sides as well as on the top.
    """

    cameras: Annotated[list[Point], Field(min_length=2)]
    target: Point
    half_angle_deg: Annotated[float, Field(gt=0, lt=90)]
    has_side_markers: bool


class Perception(Enum):
    """What tells where objects are."""

    MOCAP = "mocap"
    """Motion capture of the markers that they carry."""
    DEPTH = "depth"
    """Depth cameras over the container."""


class HandOver(Config):
    """Where the next object of a list is presented, e.g. on a tray at the end of a conveyor.

    Attributes:
        centre: place of the object's centre on the table, x and y [m].
        yaw_deg: heading of the object [deg].
    """

    centre: tuple[float, float] = (0.42, -0.36)
    yaw_deg: float = 0.0

    def pose_of(self, item: SceneItem) -> Pose:
        """X_WN: the object as announced, standing upright."""
        return Pose(np.array([*self.centre, item.half_extents[2]]), from_yaw(np.deg2rad(self.yaw_deg)))


class DrawnObjects(Config):
    """How the objects of a generated scene are drawn.

    Attributes:
        object_set: name of a file of config/object_sets.
        base_area: least and most share of the base that all objects, the new one included, cover.
    """

    object_set: Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]*$", max_length=64)]
    base_area: tuple[Share, Share]

    @model_validator(mode="after")
    def _least_first(self) -> DrawnObjects:
        if self.base_area[0] >= self.base_area[1]:
            raise ValueError("a `base_area` of two shares, the smaller one first")
        return self


class PackingCell(Config):
    """All physical facts of the packing cell, as `config/cells/packing.yaml` gives them."""

    robot: ArmDrive
    pump: Pump
    suction: Suction
    push: PushLimits
    tip: Tip | None
    """Compliance of the cup; None: the held object is rigidly fixed to it."""
    perception: Perception
    """Which of the cameras there are."""
    mocap: MocapCameras
    depth: DepthCameras
    hand_over: HandOver = HandOver()
    """Where objects of a list are handed over."""
    scene: Scene
    """The container, the objects in it and the new object, without poses."""
    drawn: DrawnObjects | None = None
    """What generated scenes have in the container instead; None: the objects of `scene`, all of them."""

    def with_arm(self, model: str) -> PackingCell:
        """The same cell with another arm model, for pictures only: home pose and gains are left unchanged."""
        return self.model_copy(update={"robot": self.robot.model_copy(update={"model": model})})


@cache
def packing_cell(over: str = "{}", layers: tuple[Layer, ...] = ()) -> PackingCell:
    """The packing cell as configured.

    Args:
        over: YAML text whose keys override those of config/cells/packing.yaml.
        layers: files that these come from, the uppermost first, for errors.

    Raises:
        ConfigError: a key or value is not allowed.
    """
    path, source = config_path("cells", "packing.yaml"), "what lies over the packing cell"
    facts = merged(load_values(path), parse_values(over, source))
    given = str(path) if over == "{}" else f"{path} and {source}"
    return validate_config(PackingCell, facts, given, folder=path.parent, layers=layers)
