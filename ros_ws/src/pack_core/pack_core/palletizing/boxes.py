"""A cardboard box as a body of the palletizing cell, and what box vision is asked and answers about one."""

from __future__ import annotations

import zlib
from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from pack_core.errors import PackError
from pack_core.rotations import Array, Pose

Dims = tuple[float, float, float]


@dataclass(frozen=True)
class BoxBody:
    """A box B with its origin in its middle.

    Attributes:
        name: name that is unique in the cell.
        size: extents along its own axes as it arrives, x along the longest side, z up [m].
        mass: mass, evenly spread [kg].
    """

    name: str
    size: tuple[float, float, float]
    mass: float

    def __post_init__(self) -> None:
        numbers = np.array([*self.size, self.mass])
        if not self.name or len(self.size) != 3 or not np.all(np.isfinite(numbers) & (numbers > 0.0)):
            raise PackError(
                f"box '{self.name}' of size {self.size} m and mass {self.mass} kg; "
                "allowed: a name, three extents and a mass above 0"
            )

    @property
    def half_extents(self) -> Array:
        """Half its size `(3,)` [m]."""
        return 0.5 * np.array(self.size)

    @property
    def inertia(self) -> Array:
        """Principal moments about its middle `(3,)` [kg m^2]."""
        x, y, z = np.square(self.size)  # of a solid cuboid: m (y^2 + z^2) / 12 about x
        return self.mass / 12.0 * np.array([y + z, x + z, x + y])

    @property
    def appearance(self) -> int:
        """A number by which the box's printing is chosen; it depends on the name alone."""
        return zlib.crc32(self.name.encode())


@dataclass(frozen=True)
class ExpectedBox:
    """The box that should be in the picture.

    Attributes:
        id: name of the box in the order.
        dims: extents d_x >= d_y >= d_z as it arrives, d_z upright [m].
        time: time from which on pictures are used [s].
    """

    id: str
    dims: Dims
    time: float


class DetectionStatus(IntEnum):
    """Outcome of a detection; the values are those of pack_interfaces/BoxDetection."""

    DETECTED = 1
    NOT_FOUND = 2
    WRONG_SIZE = 3
    DOUBTFUL = 4


@dataclass(frozen=True)
class BoxDetection:
    """What was detected in one picture.

    Attributes:
        time: when the picture was taken [s].
        box_id: name of the expected box.
        status: whether the box was detected.
        reason: why it was not, in words; empty when it was.
        X_WB: pose of the box, its origin in its middle, x along d_x; None unless detected.
        X_WT: pose of the tool (z: approach) with its pad on the middle of the top face; None unless detected.
        size: measured size of the top face, along and across [m]; zeros when not found.
    """

    time: float
    box_id: str
    status: DetectionStatus
    reason: str
    X_WB: Pose | None
    X_WT: Pose | None
    size: tuple[float, float]
