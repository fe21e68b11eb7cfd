"""Mesh files of objects: an STL or OBJ file to the corners of its convex hull."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import numpy as np

from pack_core.hull import extremes, hull_of, with_fewer_corners
from pack_core.rotations import Array
from pack_core.text.limits import MOST_BYTES_OF_MESH, MOST_MESH_CORNERS, MOST_MESH_VERTICES
from pack_core.text.shown import on_one_line, shown_value

KINDS = ("stl", "obj")
SCALES = (1e-6, 1e3)
"""Least and most metres for a mesh's unit."""
SMALLEST, LARGEST = 0.005, 2.0
"""Lengths between which every side of the bounding box is, as for every shape [m]."""
CLOSE = 0.0003
"""A hull with fewer corners is good enough if it is nowhere farther inside than this [m]."""
DIGITS = 6
"""Corners are rounded to micrometres, so that texts with them are short."""


def corners_of(file: Any, scale: Any, folder: Path | None) -> Array:
    """Corners `(n, 3)` [m] of the body that the keys `file` and `scale` of an object name.

    Args:
        file: path of the mesh from the folder.
        scale: metres for each of the mesh's units.
        folder: of the file that names the mesh; None: a text that is in no file.

    Raises:
        ValueError: a value is not allowed, or as `read_corners`.
    """
    if not isinstance(file, str):
        raise ValueError(f"a text as `file`, not {shown_value(file)}")
    if isinstance(scale, bool) or not isinstance(scale, int | float) or not SCALES[0] <= scale <= SCALES[1]:
        raise ValueError(f"a number from {SCALES[0]:g} to {SCALES[1]:g} as `scale`, not {shown_value(scale)}")
    if folder is None:
        raise ValueError(
            f"`vertices`; `file` {shown_value(file)} is for files alone, a text has none beside it"
        )
    corners = read_corners(folder / file, float(scale))
    check_size(corners)
    return corners


def check_size(points: Array) -> None:
    """Refuse a body `(n, 3)` that is too small or too large; raises ValueError."""
    sides = np.ptp(points, axis=0)
    if np.any(sides <= SMALLEST) or np.any(sides >= LARGEST):
        size = " x ".join(f"{1e3 * side:.4g}" for side in sides)
        raise ValueError(f"5 mm to 2 m along x, y and z, not {size} mm; `scale` turns units into metres")


def read_corners(path: Path, scale: float) -> Array:
    """Corners `(n, 3)` of the convex hull of a mesh, about the middle of its bounding box [m].

    Where the hull has more than `MOST_MESH_CORNERS`, those are left out whose loss changes it least.

    Args:
        path: an STL or OBJ file.
        scale: metres for each of the mesh's units.

    Raises:
        ValueError: there is no such file, it is no mesh, or it is too large or without a volume.
    """
    points = scale * _vertices(path)
    try:
        hull = with_fewer_corners(extremes(hull_of(points)), MOST_MESH_CORNERS, CLOSE)
    except ValueError as error:
        raise ValueError(f"a mesh in `file` '{on_one_line(path.name)}' of {error}") from error
    lower, upper = hull.corners.min(axis=0), hull.corners.max(axis=0)
    return np.asarray(np.round(hull.corners - 0.5 * (lower + upper), DIGITS))


def _vertices(path: Path) -> Array:
    import trimesh  # only who reads a mesh waits for it

    kind, name, content = path.suffix.lower().removeprefix("."), on_one_line(path.name), _content(path)
    if kind not in KINDS:
        raise ValueError(f"a `file` that ends in .stl or .obj, not '{name}'")
    try:
        # without `process` vertices are left as they are; no other files, such as materials, are opened
        options = {"process": False, "force": "mesh", **({"skip_materials": True} if kind == "obj" else {})}
        mesh = trimesh.load(io.BytesIO(content), file_type=kind, **options)
        vertices, faces = np.asarray(mesh.vertices, dtype=float), np.asarray(mesh.faces)
    except Exception as error:  # the readers raise whatever the bytes lead them to
        why = on_one_line(str(error))
        raise ValueError(f"a mesh; `file` '{name}' cannot be read as one: {why}") from error
    if len(faces) == 0 or vertices.shape[-1:] != (3,):
        raise ValueError(f"a mesh with faces; `file` '{name}' has none")
    if len(vertices) > MOST_MESH_VERTICES:
        raise ValueError(f"a mesh of up to {MOST_MESH_VERTICES} vertices, not {len(vertices)}")
    if not np.isfinite(vertices).all():
        raise ValueError(f"finite coordinates; `file` '{name}' has others")
    return vertices


def _content(path: Path) -> bytes:
    name = on_one_line(str(path))
    try:
        if not path.is_file():
            raise ValueError(f"a `file` that is there; {name} is not")
        if (size := path.stat().st_size) > MOST_BYTES_OF_MESH:
            most = MOST_BYTES_OF_MESH / 1e6
            raise ValueError(f"a `file` of up to {most:g} MB; {name} has {size / 1e6:.1f} MB")
        return path.read_bytes()
    except OSError as error:
        raise ValueError(f"a `file` that can be read; {name}: {error.strerror}") from error
