"""What every object that is packed has, whatever its shape, and what others ask of its shape."""

from __future__ import annotations

import colorsys
import zlib
from abc import abstractmethod
from typing import Annotated, Any, ClassVar, Self

import mujoco
import numpy as np
import shapely
from pydantic import Field

from pack_core.config import Config
from pack_core.pose_config import PoseConfig
from pack_core.rotations import Array, Pose
from pack_core.text.limits import Number, ObjectName, Share

Mass = Annotated[Number, Field(ge=0.001, le=20.0)]
Size = Annotated[Number, Field(gt=0.005, lt=2.0)]
Friction = Annotated[Number, Field(ge=0.01, le=2.0)]
Colour = tuple[Share, Share, Share]

MARKER_HEIGHT = 0.004
"""How far a marker's centre stands off the surface it is glued to [m]."""
TOP_MARKERS = 4
"""Number of markers on an object's top; they come first in `markers()`."""
CORNERS = 64
"""Corners of the polygon inscribed in a circle; its sides cut 0.12 % of the radius: 1 - cos(pi / CORNERS)."""


def colour_of(name: str) -> Colour:
    """A colour by which an object without one can be told from others; the same name has always the same."""
    return colorsys.hsv_to_rgb(zlib.crc32(name.encode()) / 2**32, 0.5, 0.8)


class SceneItem(Config):
    """An object of a scene: the origin is the centre of its bounding box, z the axis that stands upright."""

    name: ObjectName
    mass: Mass
    friction: Friction | None = Field(default=None, description="None: the scene's")
    colour: Colour = Field(
        default_factory=lambda data: colour_of(str(data.get("name", ""))), description="by default the name's"
    )
    pose: PoseConfig | None = None
    contact_dimension: ClassVar[int] = 3
    """MuJoCo's `condim`: 3 is sliding friction alone; 6 also resists spinning and rolling."""
    rolling_friction: ClassVar[float] = 0.0001
    """Rolling friction as a length [m], where the contact has one; 0.1 mm is MuJoCo's own."""

    @abstractmethod
    def geometry(self, spec: mujoco.MjSpec) -> dict[str, Any]:
        """What describes the shape to MuJoCo's `add_geom`; adds to `spec` what the geometry refers to."""

    @property
    @abstractmethod
    def half_extents(self) -> Array:
        """Half edge lengths of the bounding box `(3,)` [m]."""

    @property
    @abstractmethod
    def symmetry(self) -> float:
        """The smallest yaw that maps the upright object onto itself [rad]; 0: every yaw does."""

    @property
    def centre_of_mass(self) -> Array:
        """p_OC `(3,)` [m] of an evenly filled body; in the middle unless the shape says otherwise."""
        return np.zeros(3)

    @abstractmethod
    def half_spans(self, yaws: Array) -> Array:
        """Half the extents `(n, 2)` along the world's x and y of the upright object at each yaw [m]."""

    @abstractmethod
    def hull(self) -> Array:
        """Points `(n, 3)` in the object's frame whose convex hull is the object [m]."""

    @abstractmethod
    def top_face(self) -> Array:
        """Corners `(n, 2)` of the flat face on the top, convex [m]; none where the top is round."""

    @abstractmethod
    def markers(self) -> Array:
        """Marker centres `(6, 3)` [m], those on the top first, then one each on two upper sides."""

    @abstractmethod
    def resized(self, change: Array) -> Self:
        """The same object with lengths along x, y and z that differ by `change` `(3,)` [m]."""

    def standing(self, X_WO: Pose) -> Pose:
        """The pose with the markers on top at which the body looks as it does at X_WO, if it can lie so."""
        return X_WO

    @property
    def flat_top(self) -> float:
        """Radius of the largest disc about the z axis that lies flat on the top [m]; 0: there is none."""
        face, axis = shapely.MultiPoint(self.top_face()).convex_hull, shapely.Point(0.0, 0.0)
        return float(face.boundary.distance(axis)) if face.area > 0.0 and face.covers(axis) else 0.0


def circle(radius: float) -> Array:
    """Corners `(CORNERS, 2)` of the polygon that approximates a circle about the origin [m]."""
    angles = 2 * np.pi * np.arange(CORNERS) / CORNERS
    return np.stack([radius * np.cos(angles), radius * np.sin(angles)], axis=1)
