"""What does not stand as it should, in values and in words."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

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
        shift: how far a box was moved, in x and y of the world `(2,)` [m]; of a foreign thing, where its middle
            is. None where nothing can be said of it.
        turn_deg: by how much a box was turned, seen from above.
        size: of a foreign thing along x and y of the world, and its height over the place `(3,)` [m].
    """

    oddity: Oddity
    box: str = ""
    shift: Array | None = None
    turn_deg: float = 0.0
    size: Array | None = None

    def __str__(self) -> str:
        """In words."""
        if self.shift is not None and self.oddity is Oddity.MOVED:
            way = float((self.shift @ self.shift) ** 0.5)
            return f"box {self.box} stands {1e3 * way:.0f} mm and {abs(self.turn_deg):.1f} degrees from its place"
        if self.shift is not None and self.size is not None:
            (x, y), (length, width, height) = self.shift, self.size
            return (
                f"something stands there that should not: {length:.2f} x {width:.2f} m around x = {x:.2f}, "
                f"y = {y:.2f} m, up to {height:.2f} m high"
            )
        if self.oddity is Oddity.OTHER:
            return f"what stands in the place of box {self.box} is not of its size"
        return f"box {self.box} is gone"
