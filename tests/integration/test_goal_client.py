"""A goal sent from outside of a cell: what it waits for, the reset before it, and why it may be refused."""

from __future__ import annotations

from functools import partial
from typing import Any

import pytest
from pack_interfaces.action import Palletize
from pack_interfaces.msg import NodeStatus
from std_srvs.srv import Trigger

from integration.goal_rig import ACTION, Waiter
from integration.harness import Graph
from pack_bringup.ros import goal_client
from pack_bringup.ros.goal_client import GoalClient
from pack_core.errors import PackError
from pack_core.ros import goal_sender
from pack_core.ros.contracts.contract import Contract, Kind

RESET = Contract("/start_over", Trigger, ("user",), ("sim",), "begin anew", kind=Kind.SERVICE)


@pytest.fixture(autouse=True)
def _hurry(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(goal_sender, "SETTLE", 0.1)


def client(graph: Graph, *, order: str = "", reset: bool = False) -> GoalClient:
    """A goal's client for the one node of the cell, which waits until it is told to end."""
    wanted = (RESET, Trigger.Request()) if reset else None
    make = partial(GoalClient, ACTION, Palletize.Goal(order=order), ["waiter"], wanted)
    return graph.start(lambda parameter_overrides, **kwargs: make(**kwargs))


def pursue(graph: Graph, node: GoalClient, until: str) -> None:
    """Take the client's steps until an attribute of it is true."""

    def is_there() -> bool:
        node.pursue()
        return bool(getattr(node, until))

    graph.wait_until(is_there)


def test_a_goal_is_sent_when_every_node_is_ready_and_followed_to_its_result(graph: Graph) -> None:
    node = client(graph)
    node.pursue()
    assert node.missing == {"waiter": "not up"}
    waiter = graph.start(Waiter)
    pursue(graph, node, "feedback")
    waiter.end(True, "done")
    pursue(graph, node, "result")
    assert node.result.message == "done"


def test_what_a_node_waits_for_is_what_the_sender_waits_for(graph: Graph) -> None:
    class Late(Waiter):
        waits_for = "no /scene yet: is perception up?"

    node = client(graph)
    graph.start(Late)
    graph.wait_until(lambda: node.missing == {"waiter": "no /scene yet: is perception up?"})


def test_the_reason_of_a_refusal_reaches_who_sent_the_goal(graph: Graph) -> None:
    graph.start(Waiter)
    node = client(graph, order="refuse")
    with pytest.raises(PackError, match=r"^the goal was refused: not today$"):
        pursue(graph, node, "result")


def test_a_goal_beside_another_one_is_refused(graph: Graph) -> None:
    waiter = graph.start(Waiter)
    pursue(graph, client(graph), "is_accepted")
    graph.wait_until(lambda: waiter.is_busy)
    with pytest.raises(PackError, match="refused: a goal is in progress; cancel it first"):
        pursue(graph, client(graph), "result")


def test_a_cancelled_goal_has_a_result(graph: Graph) -> None:
    graph.start(Waiter)
    node = client(graph)
    pursue(graph, node, "feedback")
    node.cancel()
    pursue(graph, node, "result")
    assert node.result.message == "stopped on request"


@pytest.mark.parametrize("is_restarted", [False, True])
def test_a_goal_ends_with_the_node_that_pursues_it(graph: Graph, is_restarted: bool) -> None:
    waiter = graph.start(Waiter)
    node = client(graph)
    pursue(graph, node, "feedback")
    graph.wait_until(lambda: node.hears("waiter"))
    graph.stop(waiter)
    if is_restarted:
        graph.start(Waiter)  # which knows nothing of the goal
    with pytest.raises(PackError, match=r"^the goal is lost: "):
        pursue(graph, node, "result")


def test_a_goal_is_not_lost_with_a_node_that_was_started_anew_before_it_was_sent(
    graph: Graph, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(goal_client, "GRACE", 0.0)
    waiter = graph.start(Waiter)
    node = client(graph)
    graph.wait_until(lambda: node.hears("waiter"))
    graph.stop(waiter)
    graph.wait_until(lambda: not node.hears("waiter"))
    graph.start(Waiter)
    pursue(graph, node, "feedback")
    node.cancel()
    pursue(graph, node, "result")


def test_a_goal_is_given_up_when_nothing_is_heard_of_who_pursues_it(
    graph: Graph, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(goal_client, "SILENCE", 0.5)
    waiter = graph.start(Waiter)
    node = client(graph)
    pursue(graph, node, "feedback")
    graph.wait_until(lambda: node.hears("waiter"))
    waiter._ended.set()  # its heart stops; the process goes on, as one that hangs
    with pytest.raises(PackError, match=r"^the goal is lost: nothing was heard of node 'waiter'"):
        pursue(graph, node, "result")


class Sim:
    """Serves the reset."""

    def __init__(self, graph: Graph, problem: str = "") -> None:
        self.calls, self._problem = 0, problem
        graph.probe.create_service(Trigger, RESET.name, self._serve)

    def _serve(self, _: Any, response: Trigger.Response) -> Trigger.Response:
        self.calls += 1
        response.success, response.message = not self._problem, self._problem
        return response


def test_the_cell_is_put_into_the_goals_scene_before_the_goal_is_sent(graph: Graph) -> None:
    sim, waiter = Sim(graph), graph.start(Waiter)
    node = client(graph, reset=True)
    graph.wait_until(lambda: not node.missing)
    node.pursue()
    graph.wait_until(lambda: sim.calls)
    assert waiter.started == 0
    pursue(graph, node, "feedback")
    assert sim.calls == 1


def test_a_scene_that_the_cell_cannot_have_is_named(graph: Graph) -> None:
    Sim(graph, "objects overlap")
    graph.start(Waiter)
    with pytest.raises(PackError, match="cannot be put into the goal's scene: objects overlap"):
        pursue(graph, client(graph, reset=True), "result")


def test_without_a_simulator_the_way_without_reset_is_named(graph: Graph) -> None:
    graph.start(Waiter)
    with pytest.raises(PackError, match=r"no service /start_over.*--no-reset"):
        pursue(graph, client(graph, reset=True), "result")


def test_a_goal_in_progress_keeps_its_scene(graph: Graph) -> None:
    sim, waiter = Sim(graph), graph.start(Waiter)
    pursue(graph, client(graph), "is_accepted")
    other = client(graph, reset=True)
    graph.wait_until(lambda: waiter.is_busy and not other.missing)
    graph.wait_until(lambda: other._statuses["waiter"].state == NodeStatus.BUSY)
    with pytest.raises(PackError, match="node 'waiter' pursues a goal: wait for it, or cancel it"):
        pursue(graph, other, "result")
    assert sim.calls == 0
