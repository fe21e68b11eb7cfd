"""A node that fell silent is heard again, also where the middleware leaves that out."""

from __future__ import annotations

import time
from types import SimpleNamespace

import pytest
from rclpy.node import Node
from std_msgs.msg import Empty

from integration.harness import Graph
from pack_core.ros.watch.peer_watch import PeerWatch, SignOfLife

LOST = SimpleNamespace(alive_count=0)
"""What the middleware reports when a publisher has been silent for its lease."""


class Watched:
    """A node `peer` that gives signs of life whenever it is told to, and what is heard of it."""

    def __init__(self, graph: Graph) -> None:
        self.heard: list[bool] = []
        watcher = graph.start(lambda **kwargs: Node("watcher", **kwargs))
        peer = graph.start(lambda **kwargs: Node("peer", **kwargs))
        self.watch = PeerWatch(watcher, "peer", lambda _, is_alive: self.heard.append(is_alive))
        self.sign = SignOfLife(peer, "peer")

    def lose(self) -> None:
        """Have the watch told that the peer is silent; that it is heard again is never told."""
        self.watch._on_liveliness(LOST)


@pytest.fixture
def watched(graph: Graph) -> Watched:
    watched = Watched(graph)

    def is_heard() -> bool:
        watched.sign.give()
        return watched.heard == [True]

    graph.wait_until(is_heard)
    return watched


def test_a_silent_peer_is_heard_again_by_its_messages(graph: Graph, watched: Watched) -> None:
    watched.lose()

    def is_heard_again() -> bool:
        watched.sign.give()
        return watched.heard == [True, False, True]

    graph.wait_until(is_heard_again)


def test_what_was_sent_before_the_silence_tells_nothing(watched: Watched) -> None:
    before = time.time_ns()
    watched.lose()
    watched.watch._on_message(Empty(), {"source_timestamp": before})
    assert watched.heard == [True, False]
    watched.watch._on_message(Empty(), {"source_timestamp": time.time_ns()})
    assert watched.heard == [True, False, True]
