"""Physical facts of the blocks cell: `config/cells/blocks.yaml`."""

from __future__ import annotations

from functools import cache
from typing import Annotated

from pydantic import Field, PositiveFloat

from pack_core.blocks.problem import BlockSize
from pack_core.camera import PinholeCamera, focal_length
from pack_core.config import Config, load_config
from pack_core.paths import config_path
from pack_core.pose_config import PoseConfig
from pack_core.robots.joint_properties import JointServoGains
from pack_core.robots.robotiq_2f85 import MAX_FORCE, MAX_SPEED

Joints = Annotated[tuple[float, ...], Field(min_length=6, max_length=6)]


class Robot(Config):
    """Where the arm stands, and joint angles at which the camera sees past it."""

    base: PoseConfig
    look: Joints


class Gripper(Config):
    """How the fingers close."""

    force: Annotated[float, Field(gt=0, le=MAX_FORCE)]
    speed: Annotated[float, Field(gt=0, le=MAX_SPEED)]
    pad_friction: PositiveFloat
    tip_friction: PositiveFloat


class Block(Config):
    """A cube with a tag on top; a cuboid of another size is of the same wood, and its tag fits its top."""

    edge: Annotated[float, Field(gt=0.02, lt=0.08)]
    mass: PositiveFloat
    tag_edge: PositiveFloat
    friction: PositiveFloat

    @property
    def cube(self) -> BlockSize:
        """Size of a block of which nothing else is said."""
        return BlockSize(self.edge, self.edge, self.edge)

    def mass_of(self, size: BlockSize) -> float:
        """Mass of a block of a size [kg]."""
        return self.mass * (size.x * size.y * size.z) / self.edge**3

    def tag_edge_of(self, size: BlockSize) -> float:
        """Edge of the black square of a block's tag [m]: in proportion to the shorter edge of its top."""
        return self.tag_edge * (min(size.x, size.y) / self.edge)


class Table(Config):
    """The table's top at z = 0."""

    centre: tuple[float, float]
    size: tuple[PositiveFloat, PositiveFloat]
    friction: PositiveFloat


class Workspace(Config):
    """The middle of the square in which blocks may be."""

    centre: tuple[float, float]


class Camera(Config):
    """The overhead camera."""

    position: tuple[float, float, float]
    fovy_deg: Annotated[float, Field(gt=1, lt=120)]
    width: Annotated[int, Field(gt=0, le=4096)]
    height: Annotated[int, Field(gt=0, le=4096)]

    @property
    def pinhole(self) -> PinholeCamera:
        """Its intrinsics and where it is."""
        f = focal_length(self.fovy_deg, self.height)
        return PinholeCamera.looking_down(self.position, f, self.width, self.height)


class Contact(Config):
    """MuJoCo's contact parameters."""

    solref: tuple[float, float]
    finger_solref: tuple[float, float]
    """Of the gripper's fingers where they press on a block."""
    solimp: tuple[float, float, float, float, float]
    impratio: PositiveFloat
    noslip_iterations: Annotated[int, Field(ge=0)]


class BlocksCell(Config):
    """The blocks cell."""

    robot: Robot
    gripper: Gripper
    block: Block
    table: Table
    workspace: Workspace
    camera: Camera
    contact: Contact
    servo: JointServoGains


@cache
def blocks_cell() -> BlocksCell:
    """The blocks cell as configured."""
    return load_config(BlocksCell, config_path("cells", "blocks.yaml"))
