"""A rearrangement problem: where the blocks stand, and where they are to stand."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import NamedTuple

from pydantic import Field, NonNegativeFloat

from pack_core.blocks.gripper import GripperFootprint
from pack_core.blocks.planar import QUARTER, PlanarPose
from pack_core.blocks.primitive_action import PrimitiveAction
from pack_core.config import Config

CUBE_SIDE = 0.0508
"""Of a 2-inch cube [m]."""
Point = tuple[float, float]


class BlockSize(NamedTuple):
    """Edges of a cuboid along its own x, y and z [m]; z points up."""

    x: float = CUBE_SIDE
    y: float = CUBE_SIDE
    z: float = CUBE_SIDE

    @property
    def is_square(self) -> bool:
        """Whether the block looks alike after a quarter turn."""
        return self.x == self.y

    def across_and_along(self, pose: PlanarPose, heading: float) -> tuple[float, float]:
        """Extents [m] of a block at a pose, across and along a heading [rad] that one of its axes has."""
        axis = round((heading - pose.yaw) / QUARTER) % 2
        return self[1 - axis], self[axis]


CUBE = BlockSize()
"""A 2-inch cube."""
BlockSizes = Mapping[str, BlockSize]
"""Sizes of blocks [m] by id."""
CUBES: BlockSizes = MappingProxyType({})
"""Sizes where no block has one of its own: all are cubes."""


@dataclass(frozen=True)
class PlacedBlock:
    """A block, where it stands on the table, and its size."""

    id: str
    pose: PlanarPose
    size: BlockSize = CUBE


class Tolerance(Config):
    """What counts as being in place; a measured pose is never exact."""

    position: NonNegativeFloat = Field(0.002, description="from the goal [m]")
    angle_deg: NonNegativeFloat = Field(2.0, description="from the goal's yaw")
    push_line: NonNegativeFloat = Field(0.001, description="beside the line of a push into the goal [m]")
    overlap: NonNegativeFloat = Field(0.001, description="depth that two blocks may overlap as measured [m]")


@dataclass(frozen=True)
class Problem:
    """Blocks to be rearranged.

    Attributes:
        blocks: ids, measured poses and sizes; one without a goal is an obstacle, which stays where it is.
        goals: pose at the end of every block that may be moved, by id.
        workspace: corners [m] of a convex polygon in which blocks may be put down.
        symmetry: after how many equal turns a block looks alike: 1, 2 or 4 (any face may be in front).
        gripper: its room on the table.
        tolerance: what counts as in place.
        starts_may_be_outside: blocks may stand outside the workspace to begin with.
        refused: what the arm cannot do; a plan does without.
    """

    blocks: tuple[PlacedBlock, ...]
    goals: Mapping[str, PlanarPose]
    workspace: tuple[Point, ...]
    symmetry: int = 1
    gripper: GripperFootprint = field(default_factory=GripperFootprint)
    tolerance: Tolerance = field(default_factory=Tolerance)
    starts_may_be_outside: bool = False
    refused: tuple[PrimitiveAction, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "goals", MappingProxyType(dict(self.goals)))

    @property
    def starts(self) -> dict[str, PlanarPose]:
        """Measured pose of every block by id."""
        return {block.id: block.pose for block in self.blocks}

    @property
    def sizes(self) -> dict[str, BlockSize]:
        """Size of every block by id."""
        return {block.id: block.size for block in self.blocks}

    @property
    def tallest(self) -> float:
        """Height of the tallest block [m]; 0 without blocks."""
        return max((block.size.z for block in self.blocks), default=0.0)

    @property
    def obstacles(self) -> dict[str, PlanarPose]:
        """Measured pose of every block that is not to be moved, by id."""
        return {block.id: block.pose for block in self.blocks if block.id not in self.goals}
