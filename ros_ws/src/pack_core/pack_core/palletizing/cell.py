"""Physical facts of the palletizing cell: `config/cells/palletizing.yaml`."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Annotated, Self

import numpy as np
from pydantic import Field, NonNegativeFloat, PositiveFloat, PositiveInt, SerializeAsAny, model_validator

from pack_core.camera import LensDistortion, PinholeCamera, focal_length
from pack_core.config import Config, load_values, merged, validate_config
from pack_core.motion.world import Obstacle
from pack_core.palletizing.grip import GripLimits
from pack_core.palletizing.imperfections import NOWHERE, Displacement, Imperfections
from pack_core.palletizing.preset import palletizing_preset
from pack_core.palletizing.scanner import ScannerMount, Scanners
from pack_core.paths import config_path
from pack_core.robots.joint_properties import JointServoGains
from pack_core.robots.surface_gripper import GripperTool, gripper_tool
from pack_core.rotations import Array, Pose

Joints = Annotated[tuple[float, ...], Field(min_length=6, max_length=6)]
Point = tuple[float, float, float]
Pair = tuple[float, float]
Size = tuple[PositiveFloat, PositiveFloat]

PICKING_TABLE, REORIENTATION_TABLE, PALLET = "picking_table", "reorientation_table", "pallet"
"""Names of the places: table A, table B and the pallet."""


class ArmMount(Config):
    """Where the KR 210 stands, and where it starts."""

    base: Point
    """Position of its base [m]; z is the height of the pedestal."""
    home: Joints
    """Joint positions at the start [rad]."""

    @property
    def X_WB(self) -> Pose:
        """Nominal pose of the arm's base in the world."""
        return Pose(np.array(self.base))


class BoxTable(Config):
    """A table with a level rectangular top."""

    centre: Pair
    size: Size
    height: PositiveFloat
    displacement: Displacement = NOWHERE
    """From there; centre and height stay the nominal ones."""

    @property
    def middle(self) -> Array:
        """Nominal middle of the top `(3,)` [m]."""
        return np.array([*self.centre, self.height])

    def displaced(self, X_WF: Pose) -> Pose:
        """Where a frame F is that stands at X_WF on the table as it nominally is."""
        return self.displacement.applied(X_WF, self.middle)


class PalletPlace(Config):
    """A pallet on the floor; its frame P has its origin at a corner of the deck, x along the length."""

    corner: Pair
    size: Size
    deck_height: PositiveFloat
    displacement: Displacement = NOWHERE
    """From there; corner and height stay the nominal ones."""

    @property
    def middle(self) -> Array:
        """Nominal middle of the deck `(3,)` [m]."""
        x, y = np.array(self.corner) + 0.5 * np.array(self.size)
        return np.array([x, y, self.deck_height])

    def displaced(self, X_WF: Pose) -> Pose:
        """Where a frame F is that stands at X_WF on the pallet as it nominally is."""
        return self.displacement.applied(X_WF, self.middle)

    @property
    def X_WP(self) -> Pose:
        """The pallet's frame in the world."""
        return self.displaced(Pose(np.array([*self.corner, self.deck_height])))


class OverheadCameraMount(Config):
    """The overhead camera, which looks straight down at the middle of the picking table."""

    height: PositiveFloat
    """Above the table's top [m]."""
    fovy_deg: Annotated[float, Field(gt=0, lt=120)]
    width: PositiveInt
    rows: PositiveInt
    displacement: Displacement = NOWHERE
    """From there, about the camera itself."""
    focal_scale: PositiveFloat = 1.0
    """Focal length, as a share of that which `fovy_deg` says."""
    centre_shift: Pair = (0.0, 0.0)
    """Where the optical axis meets the picture, from its middle [pixel]."""
    lens: LensDistortion = LensDistortion()


class Spawn(Config):
    """Half widths of the uniform distributions of a box's offset and yaw when it arrives on the table."""

    offset: NonNegativeFloat
    yaw_deg: NonNegativeFloat


class BoxContact(Config):
    """Parameters of the contacts of boxes, tables and pallet, and which of them count as unwanted."""

    friction: PositiveFloat
    solref: Pair
    solimp: Point
    noslip_iterations: Annotated[int, Field(ge=0)]
    sleep_speed: NonNegativeFloat
    """Boxes slower than this for 10 steps sleep until something touches them [m/s, rad/s]; 0: never."""
    watch_force: PositiveFloat
    """Unwanted contacts above it are recorded [N]."""
    landing_speed: PositiveFloat
    """Speed above which a carried box that comes down on something counts as a collision [m/s]."""


class PalletizingCell(Config):
    """The palletizing cell."""

    arm: ArmMount
    tool: SerializeAsAny[GripperTool]
    """The gripper; its kind is that of `tool.kind`."""
    grip: GripLimits
    picking_table: BoxTable
    reorientation_table: BoxTable
    pallet: PalletPlace
    camera: OverheadCameraMount
    scanners: Scanners
    spawn: Spawn
    servo: JointServoGains
    contact: BoxContact
    imperfections: Imperfections
    """How the real cell differs from this one."""
    preset: str = "rigid"
    """Name of the preset that changed these facts."""

    @model_validator(mode="after")
    def _parts_fit(self) -> Self:
        if len(self.servo.inertia) != 6:
            raise ValueError(f"servo.inertia has {len(self.servo.inertia)} values; allowed: 6")
        return self

    @property
    def overhead_camera(self) -> PinholeCamera:
        """The overhead camera without its distortion; image up is +y of the world."""
        mount, (x, y) = self.camera, self.picking_table.centre
        p_WC = np.array([x, y, self.picking_table.height + mount.height])
        f = focal_length(mount.fovy_deg, mount.rows) * mount.focal_scale
        level = PinholeCamera.looking_down(p_WC, f, mount.width, mount.rows)
        u, v = (c + shift for c, shift in zip(level.c, mount.centre_shift, strict=True))
        return replace(level, X_WC=mount.displacement.applied(level.X_WC, p_WC), c=(u, v))

    @property
    def furniture(self) -> tuple[Obstacle, ...]:
        """Tables and pallet as obstacles of the arm, each a block down to the floor."""
        return (
            _block(PICKING_TABLE, self.picking_table),
            _block(REORIENTATION_TABLE, self.reorientation_table),
            _block(PALLET, self.pallet),
        )

    def scanner_pose(self, place: str) -> Pose:
        """X_WS of the scanner over a place that `Scanners` names."""
        scanner: ScannerMount = getattr(self.scanners, place)
        return scanner.X_WS(getattr(self, place).middle)

    def scanner_rays(self, place: str) -> Array:
        """Directions of that scanner's rays `(n, 3)` in its frame S, of length 1."""
        scanner: ScannerMount = getattr(self.scanners, place)
        return scanner.rays(getattr(self, place).middle, getattr(self, place).size)


def _block(name: str, place: BoxTable | PalletPlace) -> Obstacle:
    x, y, height = place.middle
    X_WO = place.displaced(Pose(np.array([x, y, height / 2.0])))
    return Obstacle(name, X_WO, np.array([*place.size, height]))


@cache
def palletizing_cell(preset: str = "rigid") -> PalletizingCell:
    """The palletizing cell as configured, with the changes of a preset; raises ConfigError."""
    path = config_path("cells", "palletizing.yaml")
    values = merged(load_values(path), palletizing_preset(preset).cell)
    tool = gripper_tool(values.get("tool", {}), f"{path}, section tool")
    given = f"{path} with the preset '{preset}'"
    return validate_config(PalletizingCell, {**values, "tool": tool, "preset": preset}, given)
