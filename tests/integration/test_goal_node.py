"""What every goal goes through: taken or refused, pursued, ended, cancelled."""

from __future__ import annotations

from typing import Any

import pytest
from action_msgs.msg import GoalStatus
from pack_interfaces.action import Palletize
from rclpy.action import ActionClient

from integration.goal_rig import ACTION, Waiter, ended, refusal, send
from integration.harness import Graph


@pytest.fixture
def waiter(graph: Graph) -> Waiter:
    return graph.start(Waiter)


def test_a_goal_is_pursued_with_feedback_to_its_result(graph: Graph, waiter: Waiter) -> None:
    heard: list[Any] = []
    handle = send(graph, feedback=heard.append)
    graph.wait_until(lambda: heard)
    assert heard[0].feedback.state == "started"
    waiter.end(True, "done")
    waiter.end_goal()  # once more does no harm
    assert ended(graph, handle) == (GoalStatus.STATUS_SUCCEEDED, "done")


def test_a_goal_that_fails_is_aborted(graph: Graph, waiter: Waiter) -> None:
    handle = send(graph)
    graph.wait_until(lambda: waiter.started)
    waiter.end(False, "in vain")
    assert ended(graph, handle) == (GoalStatus.STATUS_ABORTED, "in vain")


def test_a_second_goal_is_refused_and_a_third_is_taken_after_the_first_has_ended(
    graph: Graph, waiter: Waiter
) -> None:
    first = send(graph)
    assert refusal(graph) == "a goal is in progress; cancel it first"
    assert waiter.health.last["refused goal"] == "a goal is in progress; cancel it first"
    waiter.end(True, "")
    graph.result_of(first)
    send(graph)
    graph.wait_until(lambda: waiter.started == 2)


def test_of_two_goals_at_once_one_is_taken(graph: Graph, waiter: Waiter) -> None:
    client = ActionClient(graph.probe, ACTION.type, ACTION.name)
    graph.wait_until(client.server_is_ready)
    futures = [client.send_goal_async(Palletize.Goal()) for _ in range(2)]
    graph.wait_until(lambda: all(future.done() for future in futures))
    graph.wait_until(lambda: waiter.health.counts["refused goal"] == 1)
    assert waiter.started == 1


def test_a_cancelled_goal_ends_as_cancelled(graph: Graph, waiter: Waiter) -> None:
    handle = send(graph)
    graph.wait_until(lambda: waiter.started)
    handle.cancel_goal_async()
    assert ended(graph, handle) == (GoalStatus.STATUS_CANCELED, "stopped on request")
    assert not waiter.is_cancel_requested
    send(graph)
    graph.wait_until(lambda: waiter.started == 2)


@pytest.mark.parametrize(
    ("order", "reason"), [("refuse", "not today"), ("refuse by error", "it cannot be read")]
)
def test_a_goal_that_the_node_refuses_is_counted_and_its_sender_is_told_the_reason(
    graph: Graph, waiter: Waiter, order: str, reason: str
) -> None:
    handle = send(graph, order)
    assert ended(graph, handle) == (GoalStatus.STATUS_ABORTED, f"refused: {reason}")
    assert (waiter.health.counts["refused goal"], waiter.health.last["refused goal"]) == (1, reason)
    assert waiter.started == 0


def test_an_error_while_a_goal_is_pursued_becomes_its_message_and_the_next_goal_is_taken(
    graph: Graph, waiter: Waiter
) -> None:
    assert ended(graph, send(graph, "raise")) == (GoalStatus.STATUS_ABORTED, "it cannot be built")
    send(graph)
    graph.wait_until(lambda: waiter.started == 2)
