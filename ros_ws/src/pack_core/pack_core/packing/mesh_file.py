"""Mesh files of objects: an STL or OBJ file to the corners of its convex hull."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np

from pack_core.hull import extremes, hull_of, with_fewer_corners
from pack_core.rotations import Array
from pack_core.text.limits import MOST_BYTES_OF_MESH, MOST_MESH_CORNERS, MOST_MESH_VERTICES

KINDS = ("stl", "obj")
CLOSE = 0.0003
"""A hull with fewer corners is good enough if it is nowhere farther inside than this [m]."""
DIGITS = 6
"""Corners are rounded to micrometres, so that texts with them are short."""


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
        raise ValueError(f"a mesh in `file` '{path.name}' of {error}") from error
    lower, upper = hull.corners.min(axis=0), hull.corners.max(axis=0)
    return np.asarray(np.round(hull.corners - 0.5 * (lower + upper), DIGITS))


def _vertices(path: Path) -> Array:
    import trimesh  # only who reads a mesh waits for it

    kind, content = path.suffix.lower().removeprefix("."), _content(path)
    if kind not in KINDS:
        raise ValueError(f"a `file` that ends in .stl or .obj, not '{path.name}'")
    try:
        # without `process` vertices are left as they are; no other files, such as materials, are opened
        options = {"process": False, "force": "mesh", **({"skip_materials": True} if kind == "obj" else {})}
        mesh = trimesh.load(io.BytesIO(content), file_type=kind, **options)
        vertices, faces = np.asarray(mesh.vertices, dtype=float), np.asarray(mesh.faces)
    except Exception as error:  # the readers raise whatever the bytes lead them to
        raise ValueError(f"a mesh; `file` '{path.name}' cannot be read as one: {error}") from error
    if len(faces) == 0 or vertices.shape[-1:] != (3,):
        raise ValueError(f"a mesh with faces; `file` '{path.name}' has none")
    if len(vertices) > MOST_MESH_VERTICES:
        raise ValueError(f"a mesh of up to {MOST_MESH_VERTICES} vertices, not {len(vertices)}")
    if not np.isfinite(vertices).all():
        raise ValueError(f"finite coordinates; `file` '{path.name}' has others")
    return vertices


def _content(path: Path) -> bytes:
    try:
        if (size := path.stat().st_size) > MOST_BYTES_OF_MESH:
            most = MOST_BYTES_OF_MESH / 1e6
            raise ValueError(f"a `file` of up to {most:g} MB; '{path.name}' has {size / 1e6:.1f} MB")
        return path.read_bytes()
    except FileNotFoundError:
        raise ValueError(f"a `file` that is there; {path} is not") from None
    except OSError as error:
        raise ValueError(f"a `file` that can be read; {path}: {error.strerror}") from error
