"""A graph of its own for every integration test."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from integration.harness import Graph


@pytest.fixture
def graph() -> Iterator[Graph]:
    """An empty graph on a domain of its own."""
    graph = Graph()
    yield graph
    graph.close()
