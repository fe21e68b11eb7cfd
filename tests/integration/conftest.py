"""A graph of its own for every integration test."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from integration.harness import Graph


@pytest.fixture
def graph(monkeypatch: pytest.MonkeyPatch) -> Iterator[Graph]:
    """An empty graph on a domain of its own, on this machine only."""
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    graph = Graph()
    yield graph
    graph.close()
