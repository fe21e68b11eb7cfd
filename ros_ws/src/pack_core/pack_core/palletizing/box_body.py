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
        name: unique in the cell.
        size: extents along its own axes as it arrives, x long, z up [m].
        mass: evenly filled [kg].
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
        x, y, z = np.square(self.size)
        return self.mass / 12.0 * np.array([y + z, x + z, x + y])

    @property
    def look(self) -> int:
        """A number that its printing is chosen by, the same in every run."""
        return zlib.crc32(self.name.encode())
