"""Every node says how far it has come, to everybody and at any time."""

from __future__ import annotations

import time
from typing import Any

from pack_interfaces.msg import NodeStatus

from integration.goal_rig import Waiter, send
from integration.harness import Graph
from pack_bringup.ros.status_listener import StatusListener
from pack_core.ros.contracts import shared
from pack_core.ros.node import CellNode
from pack_core.ros.node_status import LISTENING


class Needy(CellNode):
    """Waits for what a test gives it."""

    def __init__(self, **kwargs: Any) -> None:
        self.need = "no /scene yet"
        super().__init__("needy", **kwargs)

    @property
    def waits_for(self) -> str:
        return self.need


def states(graph: Graph) -> list[tuple[int, str]]:
    """What is heard from now on, newest last."""
    heard: list[tuple[int, str]] = []
    graph.probe.create_subscription(
        NodeStatus, shared.NODE_STATUS.name, lambda s: heard.append((s.state, s.waits_for)), LISTENING
    )
    return heard


def test_a_node_says_what_it_waits_for_and_then_that_it_is_ready(graph: Graph) -> None:
    heard = states(graph)

    def make(**kwargs: Any) -> Needy:
        started = Needy(**kwargs)
        graph.wait_until(lambda: heard)  # before it has its first turn, which takes the place of what it said
        return started

    node = graph.start(make)
    graph.wait_until(lambda: (NodeStatus.WAITING, "no /scene yet") in heard)
    node.need = ""
    graph.wait_until(lambda: heard[-1] == (NodeStatus.READY, ""))
    assert heard[0] == (NodeStatus.STARTING, "")
    assert len(heard) == 3
    node.need = "no /scene any more"
    graph.wait_until(lambda: heard[-1] == (NodeStatus.WAITING, "no /scene any more"))


def test_a_late_listener_hears_where_every_node_stands(graph: Graph) -> None:
    graph.start(Needy)
    graph.start(Waiter)
    graph.wait_until_ready("waiter")
    with StatusListener(graph.context.get_domain_id()) as listener:
        assert listener.spin_until(lambda: {"needy", "waiter"} <= set(listener.statuses), 10.0)
        assert listener.unready(["needy", "waiter", "sim"]) == {"needy": "no /scene yet", "sim": "starting"}
        status = listener.statuses["waiter"]
        assert 0.0 < status.started <= status.since <= time.time()


def test_a_node_is_busy_while_it_pursues_a_goal(graph: Graph) -> None:
    waiter, heard = graph.start(Waiter), states(graph)
    graph.wait_until_ready("waiter")
    send(graph)
    graph.wait_until(lambda: heard[-1][0] == NodeStatus.BUSY)
    waiter.end(True, "")
    graph.wait_until(lambda: heard[-1][0] == NodeStatus.READY)


def test_a_peer_that_has_not_been_heard_yet_is_not_called_silent(graph: Graph) -> None:
    waiter = graph.start(Waiter)
    waiter._watches[0]._change(False)
    assert not waiter.silent_peers
    waiter._watches[0]._change(True)
    waiter._watches[0]._change(False)
    assert waiter.silent_peers
