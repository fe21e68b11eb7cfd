"""The objects that are packed: shapes with known size and mass.

Everything that depends on a shape is in its class; other code never asks for an object's type. A further
shape is one more subclass of `SceneItem`, listed in `ObjectModel`. Python refuses to create an object of a
subclass that leaves a method out.
"""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal, Self

import mujoco
import numpy as np
from pydantic import Field, model_validator

from pack_core.config import Config, parse_values, validate_config
from pack_core.packing.convex_mesh import ConvexMesh
from pack_core.packing.scene_item import CORNERS, MARKER_HEIGHT, SceneItem, Size, circle
from pack_core.rotations import Array, Pose, from_matrix, rotate

RINGS = np.deg2rad(np.arange(0.0, 90.0, 15.0))
"""Latitudes of the rings of points that stand for each half ball [rad]."""
TOP_NORMALS = np.array([[sx, sy, 1.4] for sx in (-1, 1) for sy in (-1, 1)]) / np.sqrt(3.96)
"""Where the markers of the top are glued to: normals `(4, 3)`, 45 degrees off the vertical."""
SIDE_NORMALS = np.array([[1.0, 0.0, 0.3], [0.0, 1.0, 0.3]]) / np.sqrt(1.09)
"""The same of the markers on two sides: normals `(2, 3)`, 17 degrees over the horizontal."""
SHORTEST = 0.001
"""Least length of the straight part [m]."""
UPENDED = 0.1
"""Cosine of the elevation from which a capsule that should lie stands on its end."""
LYING = (np.sqrt(0.5), 0.0, np.sqrt(0.5), 0.0)
"""Quaternion wxyz that turns MuJoCo's axis of a capsule, z, into x."""


class Capsule(SceneItem):
    """A capsule of `radius` and of `length` from end to end [m]; its axis is z, or x if it lies."""

    shape: Literal["capsule"]
    radius: Size
    length: Size
    axis: Literal["x", "z"] = "z"
    contact_dimension: ClassVar[int] = 6
    rolling_friction: ClassVar[float] = 0.0005

    @model_validator(mode="after")
    def _is_longer_than_wide(self) -> Self:
        if self.length < 2.0 * self.radius + SHORTEST:
            raise ValueError(
                f"a `length`, from end to end, of two `radius` and 1 mm or more, not {self.length}"
            )
        return self

    def geometry(self, spec: mujoco.MjSpec) -> dict[str, Any]:
        size = (self.radius, self._half_core, 0.0)
        return {"type": mujoco.mjtGeom.mjGEOM_CAPSULE, "size": size} | ({"quat": LYING} if self._lies else {})

    @property
    def half_extents(self) -> Array:
        return np.full(3, self.radius) + self._core

    @property
    def symmetry(self) -> float:
        return np.pi if self._lies else 0.0

    def half_spans(self, yaws: Array) -> Array:
        along = np.stack([np.abs(np.cos(yaws)), np.abs(np.sin(yaws))], axis=1)
        return np.asarray(self.radius + self._core[0] * along)

    def hull(self) -> Array:
        rings = [
            np.column_stack([circle(self.radius * np.cos(latitude)), np.full(CORNERS, z)])
            for latitude in RINGS
            for z in [self._half_core + self.radius * np.sin(latitude)]
        ]
        upper = np.concatenate([*rings, [[0.0, 0.0, 0.5 * self.length]]])
        points = np.concatenate([upper, upper * [1.0, 1.0, -1.0]])
        # as LYING does: z becomes x, and x becomes -z
        return points[:, [2, 1, 0]] * [1.0, 1.0, -1.0] if self._lies else points

    def top_face(self) -> Array:
        return np.zeros((0, 2))

    def markers(self) -> Array:
        """Markers about the top, each towards the end of the capsule that is nearer, and two on the sides."""
        ends = np.where(TOP_NORMALS > 0.0, 1.0, -1.0) * self._core
        normals = np.concatenate([TOP_NORMALS, SIDE_NORMALS])
        feet = np.concatenate([ends, np.sign(SIDE_NORMALS) * self._core])
        return np.asarray(feet + (self.radius + MARKER_HEIGHT) * normals)

    def standing(self, X_WO: Pose) -> Pose:
        """A capsule that lies looks alike however far it has rolled."""
        x = rotate(X_WO.q, [1.0, 0.0, 0.0])
        up = np.array([0.0, 0.0, 1.0]) - x[2] * x
        if not self._lies or np.linalg.norm(up) < UPENDED:
            return X_WO
        z = up / np.linalg.norm(up)
        return Pose(X_WO.p, from_matrix(np.column_stack([x, np.cross(z, x), z])))

    def resized(self, change: Array) -> Self:
        """The same capsule, its diameter changed as across the axis and its length as along it."""
        across, along = (change[1], change[0]) if self._lies else (change[0], change[2])
        radius = self.radius + 0.5 * across
        # a ball is no capsule to MuJoCo
        length = max(self.length + along, 2.0 * radius + 0.1 * SHORTEST)
        return self.model_copy(update={"radius": radius, "length": length})

    @property
    def _lies(self) -> bool:
        return self.axis == "x"

    @property
    def _half_core(self) -> float:
        """Half the length of the straight part [m]."""
        return 0.5 * self.length - self.radius

    @property
    def _core(self) -> Array:
        """From the middle to the middle of the half ball at the positive end `(3,)` [m]."""
        return self._half_core * (np.array([1.0, 0.0, 0.0]) if self._lies else np.array([0.0, 0.0, 1.0]))


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
