"""Limits of all text that comes from outside: sizes, names, numbers. docs/reference/limits.md lists them."""

from __future__ import annotations

import re
from typing import Annotated, Any

from pydantic import BeforeValidator, Field

MOST_BYTES = 2_000_000
"""Of one text: a file, an upload, the text in a message."""
MOST_DEPTH = 40
"""Of lists and mappings within each other."""
MOST_VALUES = 200_000
"""Values in one text, each alias (`*name`) counted with all that it stands for."""
MOST_CHARACTERS_OF_NUMBER = 40
"""The longest that a number of double precision is written with has 24."""
LARGEST_INTEGER = 2**63 - 1
"""What fits into the 64-bit integers of messages."""
MOST_CHARACTERS_OF_NAME = 64
"""Of one object, box or block; it stands in tables and in names of topics and files."""
MOST_OBJECTS = 40
"""Objects in a container, beside the new one."""
MOST_BYTES_OF_MESH = 20_000_000
"""Of a mesh file: it is read whole."""
MOST_MESH_VERTICES = 1_000_000
"""Of a mesh file, before its hull is taken; STL files repeat each vertex for every triangle."""
MOST_MESH_CORNERS = 120
"""Of the convex hull that an object is."""
MOST_BLOCKS = 100
"""In a problem of the blocks cell."""
MOST_CORNERS = 100
"""Corners of a workspace."""
MOST_BOXES = 1000
"""Boxes in an order."""

EXPONENT_ALONE = re.compile(r"[-+]?\d+[eE][-+]?\d+")
"""`1e-3`: YAML 1.1 calls a number without a point a text."""


def too_large(source: str, size: int) -> str:
    """The error about a text of `size` bytes or characters."""
    return f"{source}: {size / 1e6:.1f} MB; allowed: up to {MOST_BYTES / 1e6:g} MB of text"


def _no_other_type(value: Any) -> Any:
    """The number as written: `true` is none, nor is a text, which pydantic would convert silently."""
    if isinstance(value, str) and EXPONENT_ALONE.fullmatch(value) and len(value) < MOST_CHARACTERS_OF_NUMBER:
        return float(value)
    if isinstance(value, bool | str):
        raise ValueError(f"a number, not {'a text' if isinstance(value, str) else 'true or false'}")
    return value


Number = Annotated[float, BeforeValidator(_no_other_type), Field(allow_inf_nan=False)]
"""A finite number."""
Coordinate = Annotated[Number, Field(ge=-10.0, le=10.0)]
"""In a cell [m]."""
AngleDeg = Annotated[Number, Field(ge=-3600.0, le=3600.0)]
"""An angle [deg]; more than a turn is allowed, as sums of turns have it."""
UnitPart = Annotated[Number, Field(ge=-1.1, le=1.1)]
"""An element of a vector of length 1, written with a few digits."""
Share = Annotated[Number, Field(ge=0.0, le=1.0)]
"""A part of a whole, such as of a colour."""

ObjectName = Annotated[
    str,
    Field(
        pattern=r"^[a-z][a-z0-9_]*$", max_length=MOST_CHARACTERS_OF_NAME,
        description="lower case letters, digits, _",
    ),
]  # fmt: skip
"""Of an object in a scene: it becomes a part of names in models, topics and files."""
BlockName = Annotated[str, Field(pattern=r"^[A-Za-z0-9_]+$", max_length=MOST_CHARACTERS_OF_NAME)]
ARTICLE_NAMES = "letters, digits, spaces and . : + # / ( ) @ , = - _"
ArticleName = Annotated[
    str,
    Field(pattern=r"^\w[\w .:+#/()@,=-]*$", max_length=MOST_CHARACTERS_OF_NAME, description=ARTICLE_NAMES),
]
"""Of an order or a box, as a warehouse names it; without the signs that markup of any kind is made of."""
