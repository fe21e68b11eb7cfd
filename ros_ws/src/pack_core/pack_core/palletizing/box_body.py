"""A cardboard box as a body of the palletizing cell."""

from __future__ import annotations

import zlib
from dataclasses import dataclass

import numpy as np

from pack_core.errors import PackError
from pack_core.rotations import Array


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
    def look(self) -> int:
        """A number by which the box's printing is chosen; it depends on the name alone."""
        return zlib.crc32(self.name.encode())
