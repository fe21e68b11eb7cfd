"""Messages, services and actions explain themselves: `ros2 interface show` is all that a newcomer needs."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

import pytest

from pack_core.paths import project_root

FOLDER = project_root() / "ros_ws" / "src" / "pack_interfaces"
FILES = sorted(path for kind in ("msg", "srv", "action") for path in (FOLDER / kind).iterdir())
FIELD = re.compile(r"^(?P<type>[A-Za-z_/0-9]+)(\[[<=0-9]*\])?\s+(?P<name>\w+)\s*(?P<value>=.*)?$")
POSES = ("Pose", "Point", "Vector3", "Twist", "Wrench", "Quaternion")
FRAMES = ("frame", "axes", "X_", "world")
"""Words of which one says in what a pose or a vector is given."""
WITHOUT_UNIT = (
    "cost",
    "share",
    "step size",
    "regularisation",
    "factor",
    "unit vector",
    "quaternion",
    "number",
    "dimension",
)
"""Words of quantities that have no unit."""


@dataclass(frozen=True)
class Field:
    """A field with the comment that belongs to it: its own, or the one that it shares with those above."""

    file: str
    type: str
    name: str
    comment: str
    is_constant: bool


def fields_of(path: Path) -> list[Field]:
    fields: list[Field] = []
    above, was_field = "", False
    for line in path.read_text().splitlines():
        text, _, comment = (part.strip() for part in line.partition("#"))
        if text == "---" or not line.strip():
            above = ""
        elif not text:
            above = comment if was_field else f"{above} {comment}".strip()
        elif found := FIELD.match(text):
            said = comment or above
            fields.append(Field(path.name, found["type"], found["name"], said, bool(found["value"])))
        else:
            pytest.fail(f"{path.name}: cannot read '{line}'")
        was_field = bool(text)
    return fields


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.name)
def test_every_file_begins_with_what_it_is_for(path: Path) -> None:
    assert path.read_text().startswith("# ")


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.name)
def test_every_field_is_explained(path: Path) -> None:
    assert [field.name for field in fields_of(path) if not field.comment] == []


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.name)
def test_every_number_has_a_unit_or_none_to_have_and_every_pose_a_frame(path: Path) -> None:
    wanting = []
    for field in fields_of(path):
        said = field.comment.lower()
        if field.type in ("float64", "float32") and "[" not in said:
            if not any(word in said for word in WITHOUT_UNIT):
                wanting.append(f"{field.name}: unit? {field.comment}")
        elif field.type.split("/")[-1] in POSES and not any(word in field.comment for word in FRAMES):
            wanting.append(f"{field.name}: frame? {field.comment}")
    assert wanting == []
