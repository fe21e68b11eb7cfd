"""One class name, one thing; and files that can be read at one go."""

import ast
from collections import defaultdict
from pathlib import Path

from pack_core.paths import project_root

SOURCES = project_root() / "ros_ws" / "src"
LONGEST = 200
"""Lines of a file that can be read at one go."""
LONGER = {
    "pack_planner/pack_planner/rearrangement/beam/tables.py": "every field of one record is explained",
    "pack_motion/pack_motion/controller.py": "all that is asked of the motion, in one place",
    "pack_sim/pack_sim/palletizing/simulator.py": "one step of the whole cell, and all that is asked of it",
}
"""Files that may be longer, with the reason."""


def modules() -> list[Path]:
    return [path for package in SOURCES.glob("*/setup.py") for path in sorted(package.parent.rglob("*.py"))]


def test_no_class_name_stands_in_two_modules() -> None:
    places = defaultdict(set)
    for path in modules():
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.ClassDef):
                places[node.name].add(str(path.relative_to(SOURCES)))
    assert {name: sorted(paths) for name, paths in places.items() if len(paths) > 1} == {}


def test_files_are_no_longer_than_can_be_read_at_one_go() -> None:
    lengths = {str(path.relative_to(SOURCES)): len(path.read_text().splitlines()) for path in modules()}
    assert {path: lines for path, lines in lengths.items() if lines > LONGEST and path not in LONGER} == {}


def test_exceptions_are_still_needed_and_have_a_reason() -> None:
    for path, reason in LONGER.items():
        assert len((SOURCES / path).read_text().splitlines()) > LONGEST, f"{path} is short now: strike it"
        assert reason
