"""A graph of its own for every integration test, in which cameras open late."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest

from integration.harness import Graph
from pack_sim.blocks.overhead_camera import OverheadCamera
from pack_sim.palletizing.overhead_camera import PalletCamera


@pytest.fixture
def graph() -> Iterator[Graph]:
    """An empty graph on a domain of its own."""
    graph = Graph()
    yield graph
    graph.close()


@pytest.fixture(autouse=True)
def cameras_open_with_their_first_picture(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nodes open theirs as they start, which takes a second, and few tests want a picture."""
    _open_late(PalletCamera, "_view", monkeypatch)
    _open_late(OverheadCamera, "_renderer", monkeypatch)


def _open_late(camera: type[Any], drawing: str, patch: pytest.MonkeyPatch) -> None:
    """Have a camera make what draws, its attribute `drawing`, with the first picture."""
    enter, picture = camera.__enter__, camera.picture

    def open_and_draw(self: Any, snapshot: Any) -> Any:
        if getattr(self, drawing) is None:
            enter(self)
        return picture(self, snapshot)

    patch.setattr(camera, "__enter__", lambda self: self)
    patch.setattr(camera, "picture", open_and_draw)
