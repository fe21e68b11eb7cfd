"""The things that are packed: boxes and cylinders with known size and mass."""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from pack_core.config import Config
from pack_core.pose_config import PoseConfig
from pack_core.rotations import Array

Mass = Annotated[float, Field(gt=0.0, le=20.0)]
Size = Annotated[float, Field(gt=0.005, lt=2.0)]
Friction = Annotated[float, Field(gt=0.0, le=2.0)]
Colour = tuple[float, float, float]

MARKER_HEIGHT = 0.004
"""How far a marker's centre stands off the surface it is glued to [m]."""
TOP_MARKERS = 4
"""So many markers, the first ones, are on an object's top."""


class _Object(Config):
    """What boxes and cylinders share: the origin is the centre, z the axis that stands upright."""

    name: str = Field(pattern=r"^[a-z][a-z0-9_]*$", description="lower case letters, digits, _")
    mass: Mass
    friction: Friction | None = Field(default=None, description="None: the scene's")
    colour: Colour = (0.7, 0.7, 0.7)
    pose: PoseConfig | None = None


class Box(_Object):
    """A box with full edge lengths `size` [m]."""

    shape: Literal["box"]
    size: tuple[Size, Size, Size]

    @property
    def half_extents(self) -> Array:
        """Half edge lengths of the bounding box `(3,)` [m]."""
        return 0.5 * np.array(self.size)

    def markers(self) -> Array:
        """Marker centres `(6, 3)` [m]: the top's corners and two upper sides."""
        return _markers(self.half_extents, inset=1.0)


class Cylinder(_Object):
    """An upright cylinder, `radius` and `height` [m]."""

    shape: Literal["cylinder"]
    radius: Size
    height: Size

    @property
    def half_extents(self) -> Array:
        """Half edge lengths of the bounding box `(3,)` [m]."""
        return np.array([self.radius, self.radius, 0.5 * self.height])

    def markers(self) -> Array:
        """Marker centres `(6, 3)` [m]: four on the rim of the top and two upper sides."""
        return _markers(self.half_extents, inset=np.sqrt(0.5))


ObjectModel = Annotated[Box | Cylinder, Field(discriminator="shape")]


def _markers(half: Array, inset: float) -> Array:
    x, y, z = half
    cx, cy = inset * (x - MARKER_HEIGHT), inset * (y - MARKER_HEIGHT)
    top = [[sx * cx, sy * cy, z + MARKER_HEIGHT] for sx in (-1, 1) for sy in (-1, 1)]
    sides = [[x + MARKER_HEIGHT, 0.0, 0.7 * z], [0.0, y + MARKER_HEIGHT, 0.7 * z]]
    return np.array(top + sides)
