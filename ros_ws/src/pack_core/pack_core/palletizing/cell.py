"""Physical facts of the palletizing cell: `config/cells/palletizing.yaml`."""

from __future__ import annotations

from dataclasses import dataclass, replace
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
from pack_core.palletizing.scanner import SCANNED, ScannerMount, Scanners
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
SECOND_PALLET, REJECT_TABLE, QUEUE_BELT = "second_pallet", "reject_table", "queue_belt"
"""Names of the places that only a shift has."""
PALLETS = (PALLET, SECOND_PALLET)
"""Names of the places where pallets may stand."""


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


class Conveyor(Config):
    """A conveyor that brings boxes along -x: a belt on which they queue, then table A as a second belt.

    Both stop by light barriers: one across table A, where a box is to be picked, one where the belts meet.
    """

    length: PositiveFloat
    """Of the belt on which boxes queue [m]; it is as wide and as high as table A."""
    queue_speed: PositiveFloat
    """Of that belt [m/s]."""
    pick_speed: PositiveFloat
    """Of table A [m/s]; it is faster, so that gaps open between boxes."""
    acceleration: PositiveFloat
    """Of both belts [m/s^2]."""
    barrier: PositiveFloat
    """From the end of table A, where the front of a box to be picked stops [m]."""
    headroom: PositiveFloat
    """Over the belt with the queue, which the arm keeps free: nobody looks at what stands there [m]."""

    @model_validator(mode="after")
    def _opens_gaps(self) -> Self:
        if self.pick_speed <= self.queue_speed:
            raise ValueError(
                f"pick_speed is {self.pick_speed} m/s; allowed: more than queue_speed, {self.queue_speed}, "
                "or boxes that touch are never parted"
            )
        return self


class ShiftScanners(Config):
    """The scanners that a shift has besides, by the name of the place that each looks at."""

    picking_table: ScannerMount
    second_pallet: ScannerMount


class ShiftPlaces(Config):
    """What a cell has for shifts, besides all that it has for orders."""

    infeed: Conveyor
    second_pallet: PalletPlace
    reject_table: BoxTable
    """From which somebody takes boxes that are on no pallet."""
    buffer: tuple[Pair, ...]
    """Middles of the places on table B where boxes are set aside [m]."""
    scanners: ShiftScanners


@dataclass(frozen=True)
class Deck:
    """A level place D where boxes are put down.

    Attributes:
        name: of the place.
        X_WD: its frame: the origin at a corner of its top, x and y along its edges, z up.
        size: along x and y [m].
    """

    name: str
    X_WD: Pose
    size: tuple[float, float]


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
    shift: ShiftPlaces | None = None
    """What it has for shifts; None: orders alone are built in it."""
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
        """Tables, pallets and conveyor as obstacles of the arm, each a block down to the floor."""
        names = [PICKING_TABLE, REORIENTATION_TABLE, PALLET]
        if self.shift is not None:
            names += [SECOND_PALLET, REJECT_TABLE]
        blocks = [_block(name, self.place(name)) for name in names]
        if self.shift is not None:
            belt = self.queue_belt
            height = belt.height + self.shift.infeed.headroom
            blocks.append(_block(QUEUE_BELT, belt.model_copy(update={"height": height})))
        return tuple(blocks)

    @property
    def pallets(self) -> tuple[str, ...]:
        """Names of the places for pallets."""
        return (PALLET,) if self.shift is None else (PALLET, SECOND_PALLET)

    @property
    def scanned(self) -> tuple[str, ...]:
        """Names of the places that a scanner looks at."""
        return SCANNED if self.shift is None else (*SCANNED, *ShiftScanners.model_fields)

    @property
    def queue_belt(self) -> BoxTable:
        """The belt on which boxes queue, on from the end of table A at which they come in."""
        assert self.shift is not None
        (x, y), (length, width) = self.picking_table.centre, self.picking_table.size
        x += 0.5 * (length + self.shift.infeed.length) + SEAM
        return BoxTable(
            centre=(x, y), size=(self.shift.infeed.length, width), height=self.picking_table.height,
            displacement=self.picking_table.displacement,
        )  # fmt: skip

    def place(self, name: str) -> BoxTable | PalletPlace:
        """The table or pallet of this name."""
        is_of_shift = name in ShiftPlaces.model_fields
        found: BoxTable | PalletPlace = getattr(self.shift if is_of_shift else self, name)
        return found

    def deck(self, name: str) -> Deck:
        """The top of a table or pallet, as a place where boxes are put down."""
        place = self.place(name)
        corner = place.middle - 0.5 * np.array([*place.size, 0.0])
        return Deck(name, place.displaced(Pose(corner)), place.size)

    def scanner(self, place: str) -> ScannerMount:
        """The mount of the scanner over a place, one of `scanned`."""
        has_it = self.scanners if place in SCANNED or self.shift is None else self.shift.scanners
        mount: ScannerMount = getattr(has_it, place)
        return mount

    def scanner_pose(self, place: str) -> Pose:
        """X_WS of the scanner over a place, one of `scanned`."""
        return self.scanner(place).X_WS(self.place(place).middle)

    def scanner_rays(self, place: str) -> Array:
        """Directions of that scanner's rays `(n, 3)` in its frame S, of length 1."""
        return self.scanner(place).rays(self.place(place).middle, self.place(place).size)


SEAM = 0.005
"""Between the two belts of an infeed [m]."""


def _block(name: str, place: BoxTable | PalletPlace) -> Obstacle:
    x, y, height = place.middle
    X_WO = place.displaced(Pose(np.array([x, y, height / 2.0])))
    return Obstacle(name, X_WO, np.array([*place.size, height]))


@cache
def palletizing_cell(preset: str = "rigid") -> PalletizingCell:
    """The palletizing cell as configured, with the changes of a preset; raises ConfigError."""
    path = config_path("cells", "palletizing.yaml")
    given = palletizing_preset(preset)
    values = merged(load_values(path), given.cell)
    tool = gripper_tool(values.get("tool", {}), f"{path}, section tool")
    facts, source = {**values, "tool": tool, "preset": preset}, f"{path} with the preset '{preset}'"
    return validate_config(PalletizingCell, facts, source, layers=given.layers("cell"))
