"""One class name, one thing; and files that can be read at one go."""

import ast
from collections import defaultdict
from functools import cache
from pathlib import Path

from pack_core.paths import project_root

SOURCES = project_root() / "ros_ws" / "src"
LONGEST = 400
"""Lines of a file that holds one idea; a longer one holds two."""
SHORTEST = 40
"""Lines below which a file costs its reader more, as one more door to open, than it tells."""
SMALL_WITH_A_REASON: dict[str, str] = {
    "pack_lockstep/pack_lockstep/packing/depth_link.py": "what is packed by markers loads nothing of depth",
}
"""Files below that bound that stay although a single other file imports them, with the reason."""


def modules() -> list[Path]:
    return [path for package in SOURCES.glob("*/setup.py") for path in sorted(package.parent.rglob("*.py"))]


@cache
def nodes_of(path: Path) -> list[ast.AST]:
    """What the tests of this file ask of a module's syntax tree: its classes and imports."""
    kinds = (ast.ClassDef, ast.Import, ast.ImportFrom)
    return [node for node in ast.walk(ast.parse(path.read_text())) if isinstance(node, kinds)]


def test_no_class_name_stands_in_two_modules() -> None:
    places = defaultdict(set)
    for path in modules():
        for node in nodes_of(path):
            if isinstance(node, ast.ClassDef):
                places[node.name].add(str(path.relative_to(SOURCES)))
    assert {name: sorted(paths) for name, paths in places.items() if len(paths) > 1} == {}


def test_files_hold_one_idea() -> None:
    lengths = {str(path.relative_to(SOURCES)): len(path.read_text().splitlines()) for path in modules()}
    assert {path: lines for path, lines in lengths.items() if lines > LONGEST} == {}


def module_of(path: Path) -> str:
    """The dotted name of a module; a package's own for its `__init__.py`."""
    return ".".join(path.relative_to(SOURCES).with_suffix("").parts[1:]).removesuffix(".__init__")


def importers() -> dict[str, set[str]]:
    """The modules that import each module of this workspace."""
    known = {module_of(path) for path in modules()}
    found: dict[str, set[str]] = defaultdict(set)
    for path in modules():
        for node in nodes_of(path):
            if isinstance(node, ast.ImportFrom) and node.module:
                names = {node.module, *(f"{node.module}.{alias.name}" for alias in node.names)}
            elif isinstance(node, ast.Import):
                names = {alias.name for alias in node.names}
            else:
                continue
            for name in names & known:
                found[name].add(module_of(path))
    return found


@cache
def small_modules_of_one_importer() -> dict[str, str]:
    """Modules below the bound that exactly one other module imports, with that one."""
    used_by = importers()
    small = [
        path
        for path in modules()
        if path.name not in {"__init__.py", "setup.py"} and len(path.read_text().splitlines()) < SHORTEST
    ]
    return {
        str(path.relative_to(SOURCES)): next(iter(used_by[module_of(path)]))
        for path in small
        if len(used_by[module_of(path)]) == 1
    }


def test_a_small_module_that_one_other_imports_belongs_into_it() -> None:
    found = small_modules_of_one_importer()
    assert {path: user for path, user in found.items() if path not in SMALL_WITH_A_REASON} == {}


def test_exceptions_are_still_needed_and_have_a_reason() -> None:
    found = small_modules_of_one_importer()
    assert [path for path in SMALL_WITH_A_REASON if path not in found] == []
    assert all(SMALL_WITH_A_REASON.values())
