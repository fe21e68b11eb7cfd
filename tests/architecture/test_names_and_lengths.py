"""One class name, one thing; and files that can be read at one go."""

import ast
from collections import defaultdict
from pathlib import Path

from pack_core.paths import project_root

SOURCES = project_root() / "ros_ws" / "src"
LONGEST = 400
"""Lines of a file that holds one idea; a longer one holds two."""


def modules() -> list[Path]:
    return [path for package in SOURCES.glob("*/setup.py") for path in sorted(package.parent.rglob("*.py"))]


def test_no_class_name_stands_in_two_modules() -> None:
    places = defaultdict(set)
    for path in modules():
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.ClassDef):
                places[node.name].add(str(path.relative_to(SOURCES)))
    assert {name: sorted(paths) for name, paths in places.items() if len(paths) > 1} == {}


def test_files_hold_one_idea() -> None:
    lengths = {str(path.relative_to(SOURCES)): len(path.read_text().splitlines()) for path in modules()}
    assert {path: lines for path, lines in lengths.items() if lines > LONGEST} == {}
