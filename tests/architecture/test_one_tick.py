"""docs/concepts/one_tick.md follows the data file by file: every file is there, and no step is left out."""

from __future__ import annotations

import ast
import re
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from types import ModuleType

import pytest

from pack_core.paths import project_root
from pack_core.ros.contracts import blocks, motion, packing, palletizing, shared
from pack_core.ros.contracts.contract import Contract

ROOT = project_root()
SOURCES = ROOT / "ros_ws" / "src"
PAGE = ROOT / "docs" / "concepts" / "one_tick.md"
MOST_FILES = {
    "Packing: from a joint state to setpoints": 12,
    "Packing: from a marker frame to the scene": 10,
    "Packing: from a placement request to its answer": 12,
    "Palletizing: from an order to setpoints": 30,
    "Blocks: from a problem to setpoints": 25,
}
"""Files that a reader may have to open on each walk: what he pays for the breadth of the code."""
WIRING: tuple[ModuleType, ...] = (packing, palletizing, blocks, motion, shared)
STEP = re.compile(r"^\d+\. `(?P<file>[\w/]+\.py)`|^Over `(?P<wire>/[\w/]+)`", re.MULTILINE)


@dataclass(frozen=True)
class Stretch:
    """The files that one process runs one after the other, and the topic or service that leads to it."""

    wire: str | None
    files: tuple[str, ...]


def walks() -> dict[str, list[Stretch]]:
    """Each section of the page that lists files: its stretches in the order of the data."""
    found: dict[str, list[Stretch]] = {}
    for section in re.split(r"^## ", PAGE.read_text(), flags=re.MULTILINE)[1:]:
        title, _, text = section.partition("\n")
        stretches: list[Stretch] = []
        for step in STEP.finditer(text):
            if step["wire"] or not stretches:
                stretches.append(Stretch(step["wire"], ()))
            if step["file"]:
                last = stretches.pop()
                stretches.append(Stretch(last.wire, (*last.files, step["file"])))
        if stretches:
            found[title.strip()] = stretches
    return found


WALKS = walks()
on_every_walk = pytest.mark.parametrize("title", WALKS)


def path_of(file: str) -> Path:
    """A file as the page names it, e.g. `pack_mpc/mpc_node.py`."""
    return SOURCES / file.split("/")[0] / file


def module_of(file: str) -> str:
    return file.removesuffix(".py").removesuffix("/__init__").replace("/", ".")


@cache
def imports_of(file: str) -> frozenset[str]:
    """Modules that a file imports from, and `module.name` for every name that it takes."""
    found: set[str] = set()
    for node in ast.walk(ast.parse(path_of(file).read_text())):
        if isinstance(node, ast.ImportFrom) and node.module:
            found |= {node.module, *(f"{node.module}.{alias.name}" for alias in node.names)}
        elif isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
    return frozenset(found)


def leads_to(one: str, other: str) -> bool:
    """Whether a file imports another one, or names its module in a register."""
    named = re.search(rf"\"{re.escape(module_of(other))}\b", path_of(one).read_text())
    return module_of(other) in imports_of(one) or named is not None


def are_joined(one: str, other: str) -> bool:
    return leads_to(one, other) or leads_to(other, one)


@cache
def wires_of(file: str) -> frozenset[str]:
    """Topics, services and actions that a file names by their contracts."""
    words = set(re.findall(r"\w+", path_of(file).read_text()))
    return frozenset(
        contract.name
        for table in WIRING
        for name, contract in vars(table).items()
        if isinstance(contract, Contract) and name in words
    )


def test_the_page_has_every_walk() -> None:
    assert list(WALKS) == list(MOST_FILES)


@on_every_walk
def test_every_file_of_a_walk_exists(title: str) -> None:
    files = [file for stretch in WALKS[title] for file in stretch.files]
    assert [file for file in files if not path_of(file).is_file()] == []
    assert len(files) == len(set(files))


@on_every_walk
def test_every_file_is_joined_to_one_before_it(title: str) -> None:
    loose = [
        file
        for stretch in WALKS[title]
        for k, file in enumerate(stretch.files)
        if k > 0 and not any(are_joined(file, before) for before in stretch.files[:k])
    ]
    assert loose == []


@on_every_walk
def test_what_leads_to_the_next_process_is_named_on_both_sides(title: str) -> None:
    stretches = WALKS[title]
    for k, after in enumerate(stretches[1:], start=1):
        before = [file for stretch in stretches[:k] for file in stretch.files]
        assert after.wire is not None
        assert any(after.wire in wires_of(file) for file in before), f"nobody sends {after.wire}"
        assert any(after.wire in wires_of(file) for file in after.files), f"nobody takes {after.wire}"


@on_every_walk
def test_a_walk_opens_few_files(title: str) -> None:
    assert sum(len(stretch.files) for stretch in WALKS[title]) <= MOST_FILES[title]
