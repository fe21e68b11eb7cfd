"""A graph of its own for every integration test, in which cameras open late."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest
from rclpy.duration import Duration

from integration.harness import Graph
from pack_core.ros.watch.peer_watch import ALIVE_QOS
from pack_sim.blocks.overhead_camera import OverheadCamera
from pack_sim.palletizing.overhead_camera import PalletCamera

LEASE = Duration(seconds=3)
"""Silence after which a node counts as dead: all nodes of a test share one process, which a busy machine may
keep waiting for longer than the half second that separate ones have."""


@pytest.fixture
def nodes_are_given_time(monkeypatch: pytest.MonkeyPatch) -> None:
    """No node counts as dead because the machine is busy: for tests in which none is to be silent."""
    monkeypatch.setattr(ALIVE_QOS, "liveliness_lease_duration", LEASE)


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
