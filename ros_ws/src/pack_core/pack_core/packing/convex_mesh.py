"""Convex bodies of any form, given by their corners or by a mesh file whose hull they are."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Annotated, Any, Literal, Self

import mujoco
import numpy as np
from pydantic import Field, ValidationInfo, field_validator, model_validator

from pack_core.config import FOLDER
from pack_core.hull import Hull, hull_of
from pack_core.packing.mesh_file import check_size, corners_of
from pack_core.packing.scene_item import MARKER_HEIGHT, SceneItem
from pack_core.rotations import Array
from pack_core.text.limits import MOST_MESH_CORNERS, Coordinate

Corner = tuple[Coordinate, Coordinate, Coordinate]
OFF_CENTRE = 1e-4
"""Farthest that the middle of the bounding box may be from the origin [m]."""
ALIKE = 0.0005
"""A turn maps the body onto itself if no corner is farther outside than this afterwards, and the top is flat
as far as corners are this close below its height [m]."""
FOLDS = (12, 8, 6, 5, 4, 3, 2)
"""Rotational symmetries that are looked for, beside that of a body of revolution."""
ODD_TURNS = np.array([0.1, 0.37, 0.71, 1.3, 2.2])
"""Yaws that no symmetry of `FOLDS` has; a body which all of them leave alike is one of revolution [rad]."""
MARKER_RAYS = np.array(
    [*([sx * 0.55, sy * 0.55, 1.0] for sx in (-1, 1) for sy in (-1, 1)), [1.0, 0.0, 0.35], [0.0, 1.0, 0.35]]
)
"""Where markers are glued to: where rays from the middle leave, in shares of the half extents `(6, 3)`."""


@dataclass(frozen=True)
class _Form:
    """What follows from the corners.

    Attributes:
        hull: the body.
        centroid: of its volume, `(3,)` [m].
        symmetry: as `SceneItem` has it [rad].
    """

    hull: Hull
    centroid: Array
    symmetry: float


class ConvexMesh(SceneItem):
    """The convex hull of `vertices` [m], whose bounding box has its middle at the origin.

    A file may name a mesh in their place: `file`, an STL or OBJ file beside it, and `scale`, metres for each
    of the mesh's units, 1 by default. What is written or sent has vertices.
    """

    shape: Literal["mesh"]
    vertices: Annotated[tuple[Corner, ...], Field(min_length=4, max_length=MOST_MESH_CORNERS)]

    @model_validator(mode="before")
    @classmethod
    def _read(cls, values: Any, info: ValidationInfo) -> Any:
        """Put the vertices of a mesh file in the place of its name."""
        if not isinstance(values, dict) or ("vertices" in values and "file" not in values):
            return values
        if "vertices" in values or "file" not in values:
            raise ValueError("either `file`, an STL or OBJ file, or `vertices`")
        kept = {key: value for key, value in values.items() if key not in ("file", "scale")}
        corners = corners_of(values["file"], values.get("scale", 1.0), (info.context or {}).get(FOLDER))
        return {**kept, "vertices": tuple(map(tuple, corners.tolist()))}

    @field_validator("vertices")
    @classmethod
    def _is_a_body(cls, vertices: tuple[Corner, ...]) -> tuple[Corner, ...]:
        points = np.array(vertices)
        check_size(points)
        middle = 0.5 * (points.min(axis=0) + points.max(axis=0))
        if np.any(np.abs(middle) > OFF_CENTRE):
            raise ValueError(f"corners about the middle of their bounding box, which is at {middle.tolist()}")
        hull_of(points)
        return vertices

    def geometry(self, spec: mujoco.MjSpec) -> dict[str, Any]:
        hull = self._form.hull
        spec.add_mesh(
            name=self.name, uservert=hull.corners.ravel(), userface=hull.faces.ravel(),
            inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_CONVEX,
        )  # fmt: skip
        return {"type": mujoco.mjtGeom.mjGEOM_MESH, "meshname": self.name}

    @property
    def half_extents(self) -> Array:
        return np.asarray(0.5 * np.ptp(self._form.hull.corners, axis=0))

    @property
    def symmetry(self) -> float:
        return self._form.symmetry

    @property
    def centre_of_mass(self) -> Array:
        return self._form.centroid.copy()

    def half_spans(self, yaws: Array) -> Array:
        """The farther side of the two along each axis, where the outline has no middle."""
        x, y, _ = self._form.hull.corners.T
        c, s = np.cos(yaws)[:, None], np.sin(yaws)[:, None]
        return np.stack([np.abs(c * x - s * y).max(axis=1), np.abs(s * x + c * y).max(axis=1)], axis=1)

    def hull(self) -> Array:
        return self._form.hull.corners.copy()

    def top_face(self) -> Array:
        corners = self._form.hull.corners
        return np.asarray(corners[corners[:, 2] > corners[:, 2].max() - ALIKE, :2])

    def markers(self) -> Array:
        """Markers all around the middle of the top, and on two sides, along the surface's normals."""
        feet, normals = self._form.hull.exits(self._form.centroid, MARKER_RAYS * self.half_extents)
        return np.asarray(feet + MARKER_HEIGHT * normals)

    def resized(self, change: Array) -> Self:
        scaled = np.array(self.vertices) * (1.0 + 0.5 * change / self.half_extents)
        return self.model_copy(update={"vertices": tuple(map(tuple, scaled.tolist()))})

    @property
    def _form(self) -> _Form:
        return _form_of(self.vertices)


@lru_cache(maxsize=256)
def _form_of(vertices: tuple[Corner, ...]) -> _Form:
    hull = hull_of(np.array(vertices))
    return _Form(hull, hull.centroid, _symmetry(hull))


def _symmetry(hull: Hull) -> float:
    if all(_is_alike(hull, yaw) for yaw in ODD_TURNS):
        return 0.0
    return next((2 * np.pi / n for n in FOLDS if _is_alike(hull, 2 * np.pi / n)), 2 * np.pi)


def _is_alike(hull: Hull, yaw: float) -> bool:
    """Whether the body looks the same when it is turned about the z axis."""
    c, s = np.cos(yaw), np.sin(yaw)
    turned = hull.corners @ np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
    return bool(hull.heights(turned).max() < ALIKE)
