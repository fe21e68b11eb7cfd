"""What does not stand as it should, in values and in words."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum

import numpy as np

from pack_core.rotations import Array


class Oddity(Enum):
    """What can be wrong with what stands at a place."""

    MISSING = "missing"
    MOVED = "moved"
    OTHER = "other"
    FOREIGN = "foreign"


@dataclass(frozen=True)
class Finding:
    """One thing that is not as it should be.

    Attributes:
        oddity: what is wrong.
        box: name of the box that it is wrong with; empty for what belongs to no box.
        shift_W: how far a box was moved, in x and y `(2,)` [m].
        turn_deg: by how much a box was turned, seen from above.
        middle_W: where the middle of a foreign thing is, in x and y `(2,)` [m].
        size: of a foreign thing along x and y of the world, and its height over the place `(3,)` [m].
    """

    oddity: Oddity
    box: str = ""
    shift_W: Array = field(default_factory=lambda: np.zeros(2))
    turn_deg: float = 0.0
    middle_W: Array = field(default_factory=lambda: np.zeros(2))
    size: Array = field(default_factory=lambda: np.zeros(3))

    def __str__(self) -> str:
        """In words."""
        if self.oddity is Oddity.MISSING:
            return f"box {self.box} is gone"
        if self.oddity is Oddity.OTHER:
            return f"what stands in the place of box {self.box} is not of its size"
        if self.oddity is Oddity.MOVED:
            way, turn = 1e3 * float(np.linalg.norm(self.shift_W)), abs(self.turn_deg)
            return f"box {self.box} stands {way:.0f} mm and {turn:.1f} degrees from its place"
        (x, y), (length, width, height) = self.middle_W, self.size
        return (
            f"something of {length:.2f} x {width:.2f} x {height:.2f} m that should not be there, "
            f"at x = {x:.2f}, y = {y:.2f} m"
        )
