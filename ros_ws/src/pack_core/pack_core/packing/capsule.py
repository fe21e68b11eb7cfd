"""Capsules: cylinders with half a ball at each end, such as a sausage, a tube or a small melon."""

from __future__ import annotations

from typing import Any, ClassVar, Literal, Self

import mujoco
import numpy as np
from pydantic import model_validator

from pack_core.packing.scene_item import CORNERS, MARKER_HEIGHT, SceneItem, Size, circle
from pack_core.rotations import Array, Pose, from_matrix, rotate

RINGS = np.deg2rad(np.arange(0.0, 90.0, 15.0))
"""Latitudes of the rings of points that stand for each half ball [rad]."""
TOP_NORMALS = np.array([[sx, sy, 1.4] for sx in (-1, 1) for sy in (-1, 1)]) / np.sqrt(3.96)
"""Where the markers of the top are glued to: normals `(4, 3)`, 45 degrees off the vertical."""
SIDE_NORMALS = np.array([[1.0, 0.0, 0.3], [0.0, 1.0, 0.3]]) / np.sqrt(1.09)
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
