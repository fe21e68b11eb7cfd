"""The objects that are packed: shapes with known size and mass.

Everything that depends on a shape is in its class; other code never asks for an object's type. A further
shape is one more subclass of `SceneItem`, listed in `ObjectModel`. Python refuses to create an object of a
subclass that leaves a method out.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

import mujoco
import numpy as np
from pydantic import Field

from pack_core.config import Config, parse_values, validate_config
from pack_core.packing.capsule import Capsule
from pack_core.packing.convex_mesh import ConvexMesh
from pack_core.packing.scene_item import MARKER_HEIGHT, SceneItem, Size, circle
from pack_core.rotations import Array


class Box(SceneItem):
    """A box with full edge lengths `size` [m]."""

    shape: Literal["box"]
    size: tuple[Size, Size, Size]

    def geometry(self, spec: mujoco.MjSpec) -> dict[str, Any]:
        return {"type": mujoco.mjtGeom.mjGEOM_BOX, "size": self.half_extents}

    @property
    def half_extents(self) -> Array:
        return 0.5 * np.array(self.size)

    @property
    def symmetry(self) -> float:
        return np.pi / 2 if np.isclose(self.size[0], self.size[1]) else np.pi

    def half_spans(self, yaws: Array) -> Array:
        x, y, _ = self.half_extents
        c, s = np.abs(np.cos(yaws)), np.abs(np.sin(yaws))
        return np.stack([c * x + s * y, s * x + c * y], axis=1)

    def hull(self) -> Array:
        x, y, z = self.half_extents
        return np.array([[sx * x, sy * y, sz * z] for sx in (-1, 1) for sy in (-1, 1) for sz in (-1, 1)])

    def top_face(self) -> Array:
        return self.hull()[1::2, :2]

    def markers(self) -> Array:
        """Markers at the corners of the top, and one on each of two sides."""
        return _markers(self.half_extents, inset=1.0)

    def resized(self, change: Array) -> Self:
        return self.model_copy(update={"size": tuple((np.array(self.size) + change).tolist())})


class Cylinder(SceneItem):
    """An upright cylinder, `radius` and `height` [m]."""

    shape: Literal["cylinder"]
    radius: Size
    height: Size

    def geometry(self, spec: mujoco.MjSpec) -> dict[str, Any]:
        return {"type": mujoco.mjtGeom.mjGEOM_CYLINDER, "size": (self.radius, 0.5 * self.height, 0.0)}

    @property
    def half_extents(self) -> Array:
        return np.array([self.radius, self.radius, 0.5 * self.height])

    @property
    def symmetry(self) -> float:
        return 0.0

    def half_spans(self, yaws: Array) -> Array:
        return np.full((len(yaws), 2), self.radius)

    def hull(self) -> Array:
        rim = circle(self.radius)
        return np.concatenate([np.insert(rim, 2, side * 0.5 * self.height, axis=1) for side in (-1, 1)])

    def top_face(self) -> Array:
        return circle(self.radius)

    def markers(self) -> Array:
        """Markers on the rim of the top, at 45 degrees: x and y are there sqrt(1/2) of the radius."""
        return _markers(self.half_extents, inset=np.sqrt(0.5))

    def resized(self, change: Array) -> Self:
        """The same cylinder, its diameter changed by `change[0]` and its height by `change[2]` [m]."""
        return self.model_copy(
            update={"radius": self.radius + 0.5 * change[0], "height": self.height + change[2]}
        )


ObjectModel = Annotated[Box | Cylinder | Capsule | ConvexMesh, Field(discriminator="shape")]
"""Every shape that a scene file can name."""


class _OneObject(Config):
    """An object in a text of its own."""

    object: ObjectModel


def parse_object(text: str, source: str) -> ObjectModel:
    """Read one object as a scene file has it; `source` names the text in errors.

    Raises:
        ConfigError: a key or value is not allowed.
    """
    return validate_config(_OneObject, {"object": parse_values(text, source)}, source).object


def _markers(half: Array, inset: float) -> Array:
    """Markers `(6, 3)`: four on the top at `inset` times its half extents, moved in by a marker's size."""
    x, y, z = half
    cx, cy = inset * (x - MARKER_HEIGHT), inset * (y - MARKER_HEIGHT)
    top = [[sx * cx, sy * cy, z + MARKER_HEIGHT] for sx in (-1, 1) for sy in (-1, 1)]
    sides = [[x + MARKER_HEIGHT, 0.0, 0.7 * z], [0.0, y + MARKER_HEIGHT, 0.7 * z]]
    return np.array(top + sides)
