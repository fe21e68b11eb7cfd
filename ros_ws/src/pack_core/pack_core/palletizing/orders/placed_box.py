"""A box where it stands on the pallet: an axis-parallel block.

Pallet frame P: origin at a corner of the deck's top, x along the pallet's length, y along its width, z up.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from pack_core.rotations import Array

TOUCH = 1e-5
"""Boxes nearer than this touch, and those that overlap by more than this overlap [m].

It is for rounding, and far below the millimetres in which orders are written.
"""


@dataclass(frozen=True)
class PlacedBox:
    """A box on the pallet.

    Attributes:
        id: name of the box.
        lower: corner with the smallest coordinates `(3,)` in P [m].
        size: extents along the axes of P `(3,)` [m].
        mass: mass of the box [kg].
        max_load: what may stand on it [kg]; infinite: anything.
        max_pressure: largest pressure on its top [kPa]; infinite: any.
    """

    id: str
    lower: Array
    size: Array
    mass: float
    max_load: float = float("inf")
    max_pressure: float = float("inf")

    def __post_init__(self) -> None:
        for name in ("lower", "size"):
            values = np.array(getattr(self, name), dtype=float)
            values.setflags(write=False)
            object.__setattr__(self, name, values)

    @property
    def upper(self) -> Array:
        """Corner with the largest coordinates `(3,)` in P [m]."""
        return self.lower + self.size

    @property
    def centre(self) -> Array:
        """The middle of the block `(3,)` in P [m], taken as its centre of mass."""
        return self.lower + 0.5 * self.size

    def moved(self, displacement: npt.ArrayLike) -> PlacedBox:
        """The same box, displaced by `(3,)` [m]."""
        return replace(self, lower=self.lower + np.asarray(displacement, dtype=float))

    def clearance(self, other: PlacedBox) -> Array:
        """Free distance to another box along each axis `(3,)` [m]; negative where the extents overlap."""
        return np.maximum(self.lower - other.upper, other.lower - self.upper)

    def overlaps(self, other: PlacedBox) -> bool:
        """Whether the two boxes overlap in space."""
        return bool(np.all(self.clearance(other) < -TOUCH))

    def is_beside(self, other: PlacedBox) -> bool:
        """Whether the height intervals of the two boxes overlap."""
        return bool(self.clearance(other)[2] < -TOUCH)

    def is_over(self, other: PlacedBox) -> bool:
        """Whether the two boxes overlap seen from above, and this one is above the other."""
        above, clear = self.lower[2] >= other.upper[2] - TOUCH, self.clearance(other)[:2]
        return bool(above and np.all(clear < -TOUCH))

    def rests_on(self, other: PlacedBox) -> bool:
        """Whether this box's base lies on the other's top."""
        return self.is_over(other) and bool(self.lower[2] - other.upper[2] < TOUCH)
