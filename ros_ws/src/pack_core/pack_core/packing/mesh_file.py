"""Mesh files of objects: an STL or OBJ file to the corners of its convex hull."""

from __future__ import annotations

import io
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from pack_core.hull import extremes, hull_of, with_fewer_corners
from pack_core.rotations import Array
from pack_core.text.limits import MOST_BYTES_OF_MESH, MOST_MESH_CORNERS, MOST_MESH_VERTICES
from pack_core.text.shown import on_one_line, shown_value

KINDS = ("stl", "obj")
MARK = b"\xef\xbb\xbf"
"""The byte order mark that some editors put in front of a text."""
STL_HEAD = 84
"""Bytes in front of a binary STL file's triangles: 80 of a title, then the number of triangles."""
STL_FACET = np.dtype([("normal", "<3f4"), ("corners", "<9f4"), ("attribute", "<u2")])
"""A triangle in a binary STL file."""
STL_BLOCKS = {"solid": [], "facet": ["solid"], "outer": ["solid", "facet"]}
"""Words that begin a block in an STL file that is a text, and within which blocks they stand."""
STL_ENDS = {"solid": "endsolid", "facet": "endfacet", "outer": "endloop"}
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
    """The corners of all faces of a mesh `(n, 3)`, in its own units."""
    kind, name, content = path.suffix.lower().removeprefix("."), on_one_line(path.name), _content(path)
    if kind not in KINDS:
        raise ValueError(f"a `file` that ends in .stl or .obj, not '{name}'")
    try:
        vertices = _corners_of_obj(content) if kind == "obj" else _corners_of_stl(content)
    except ValueError as error:
        raise ValueError(f"a mesh; `file` '{name}' cannot be read as one: {error}") from error
    if len(vertices) == 0:
        raise ValueError(f"a mesh with faces; `file` '{name}' has none")
    if len(vertices) > MOST_MESH_VERTICES:
        raise ValueError(f"a mesh of up to {MOST_MESH_VERTICES} vertices, not {len(vertices)}")
    if not np.isfinite(vertices).all():
        raise ValueError(f"finite coordinates; `file` '{name}' has others")
    return vertices


def _corners_of_obj(content: bytes) -> Array:
    """The vertices that faces of an OBJ file name, in the file's order; other keywords are passed over."""
    vertices: list[list[float]] = []
    used: set[int] = set()
    for number, words in _lines(content):
        try:
            if words[0] == "v":
                vertices.append(_three(words[1:]))
            elif words[0] == "f":
                used |= _face(words[1:], len(vertices))
        except ValueError as error:
            raise ValueError(f"line {number}: {error}") from error
    if used and max(used) >= len(vertices):
        raise ValueError(f"a face names vertex {max(used) + 1}, but there are {len(vertices)}")
    return np.array([vertices[k] for k in sorted(used)]).reshape(-1, 3)


def _face(words: list[str], before: int) -> set[int]:
    """The vertices of a face, from 0; `before` of them stand in front of it, from which it may count back."""
    found = set()
    for word in words:
        text = word.partition("/")[0]  # behind it follow its texture and its normal
        try:
            index = int(text)
        except ValueError:
            raise ValueError(f"a face with {shown_value(word)}; allowed: numbers of vertices") from None
        if index == 0 or index < -before:
            raise ValueError(f"a face names vertex {index}; allowed: from 1, or from -1 to -{before}")
        found.add(index - 1 if index > 0 else before + index)
    if len(words) < 3:
        raise ValueError(f"a face of {len(words)} vertices; allowed: 3 or more")
    return found


def _corners_of_stl(content: bytes) -> Array:
    """The corners of the triangles of an STL file, in its order; those of neighbours come again and again."""
    if len(content) >= STL_HEAD and len(content) == STL_HEAD + STL_FACET.itemsize * _facet_count(content):
        return np.frombuffer(content, STL_FACET, offset=STL_HEAD)["corners"].reshape(-1, 3).astype(float)
    if content.removeprefix(MARK).lstrip()[:5].lower() == b"solid":
        return _corners_of_text(content)
    if len(content) < STL_HEAD:
        raise ValueError(f"{len(content)} bytes; a binary STL file has at least {STL_HEAD}")
    count = _facet_count(content)
    size = STL_HEAD + STL_FACET.itemsize * count
    raise ValueError(f"it tells of {count} triangles, {size} bytes, and has {len(content)} bytes")


def _facet_count(content: bytes) -> int:
    """The number of triangles that the head of a binary STL file gives."""
    return int.from_bytes(content[STL_HEAD - 4 : STL_HEAD], "little")


def _corners_of_text(content: bytes) -> Array:
    """The corners in an STL file that is a text: solids of facets of three vertices, each of them ended."""
    corners: list[list[float]] = []
    opened: list[str] = []
    begun = 0
    for number, words in _lines(content):
        word = words[0].lower()
        if word in STL_BLOCKS:
            if opened != STL_BLOCKS[word]:
                raise ValueError(f"line {number}: `{word}` within `{' '.join(opened) or 'nothing'}`")
            opened, begun = [*opened, word], len(corners)
        elif word == "vertex" and opened[-1:] == ["outer"]:
            try:
                corners.append(_three(words[1:]))
            except ValueError as error:
                raise ValueError(f"line {number}: {error}") from error
        elif opened and word == STL_ENDS[opened[-1]]:
            if word == "endloop" and len(corners) - begun != 3:
                raise ValueError(f"line {number}: a facet of {len(corners) - begun} vertices; allowed: 3")
            opened.pop()
        else:
            raise ValueError(
                f"line {number}: `{on_one_line(words[0])}` within `{' '.join(opened) or 'nothing'}`"
            )
    if opened:
        raise ValueError(f"it ends within `{' '.join(opened)}`: it was cut off")
    return np.array(corners).reshape(-1, 3)


def _three(words: list[str]) -> list[float]:
    """The coordinates of a vertex, behind which weights or colours may follow."""
    if len(words) < 3:
        raise ValueError(f"a vertex of {len(words)} coordinates; allowed: 3")
    try:
        return [float(word) for word in words[:3]]
    except ValueError:
        raise ValueError(f"a vertex {shown_value(' '.join(words))}; allowed: three numbers") from None


def _lines(content: bytes) -> Iterator[tuple[int, list[str]]]:
    """Number and words of each line that has any, without comments; a backslash at an end joins the next."""
    # Names of objects and materials may be in whatever encoding.
    text, begun, before = content.removeprefix(MARK).decode("latin-1"), 0, ""
    for number, line in enumerate(io.StringIO(text, newline=None), start=1):
        code = before + line.partition("#")[0].rstrip()
        begun = begun or number
        if code.endswith("\\"):
            before = code[:-1] + " "
            continue
        if words := code.split():
            yield begun, words
        begun, before = 0, ""


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
