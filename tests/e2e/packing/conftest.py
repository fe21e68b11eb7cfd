"""A running cell: its five nodes as processes, and a probe on their domain."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from e2e.packing.cell import Cell
from integration.harness import Graph


@pytest.fixture
def cell(tmp_path: Path) -> Iterator[Cell]:
    """The packing cell with the easy scene, all nodes up."""
    graph = Graph()
    with Cell(graph, tmp_path / "run") as cell:
        yield cell
    graph.close()
