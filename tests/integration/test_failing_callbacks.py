"""What callbacks raise: counted, named, answered, and survived."""

from __future__ import annotations

from typing import Any

import pytest
from pack_interfaces.srv import StopArm
from std_msgs.msg import Float64

from integration.harness import Graph
from pack_core.errors import MessageError
from pack_core.ros.contracts import shared
from pack_core.ros.health import IN_A_ROW
from pack_core.ros.node import CellNode


class ClumsyNode(CellNode):
    """Refuses numbers below zero, fails at 13, and fails in its service unless a reason is given."""

    def __init__(self, **kwargs: Any) -> None:
        super().__init__("clumsy", **kwargs)
        self.taken: list[float] = []
        self.told: list[str] = []
        self.listen(shared.REAL_TIME_FACTOR, self._on_number)
        self.create_service(StopArm, shared.STOP_ARM.name, self._on_stop)

    def on_failure(self, reason: str) -> None:
        self.told.append(reason)

    def _on_number(self, message: Float64) -> None:
        if message.data < 0.0:
            raise MessageError("below zero")
        if message.data == 13.0:
            raise KeyError("thirteen")
        self.taken.append(message.data)

    def _on_stop(self, request: StopArm.Request, response: StopArm.Response) -> StopArm.Response:
        if not request.reason:
            raise ZeroDivisionError
        return response


@pytest.fixture
def node(graph: Graph) -> ClumsyNode:
    graph.failures_allowed = True
    node = graph.start(ClumsyNode)
    graph.connect(shared.REAL_TIME_FACTOR)
    return node


def send(graph: Graph, *numbers: float) -> None:
    for number in numbers:
        graph.probe.send(shared.REAL_TIME_FACTOR, Float64(data=number))


def test_a_refused_message_is_no_failure_and_a_failure_ends_nothing(graph: Graph, node: ClumsyNode) -> None:
    send(graph, 1.0, -1.0, 13.0, 2.0)
    graph.wait_until(lambda: node.taken == [1.0, 2.0])
    topic = shared.REAL_TIME_FACTOR.name
    assert node.health.last == {f"refused {topic}": "below zero", f"failed {topic}": "KeyError('thirteen')"}
    graph.wait_until(lambda: node.told == [f"{topic} failed: KeyError('thirteen')"])


def test_a_callback_that_always_fails_is_a_fault_until_it_succeeds(graph: Graph, node: ClumsyNode) -> None:
    send(graph, *[13.0] * IN_A_ROW)
    graph.wait_until(lambda: node.health.faults)
    assert f"has failed {IN_A_ROW} times in a row: KeyError('thirteen')" in str(node.health.faults)
    send(graph, 1.0)
    graph.wait_until(lambda: not node.health.faults)


def test_a_service_that_fails_answers_with_the_reason(graph: Graph, node: ClumsyNode) -> None:
    answer = graph.call(shared.STOP_ARM, StopArm.Request())
    assert not answer.success
    assert "/arm/stop failed: ZeroDivisionError()" in answer.message


def test_a_service_that_always_fails_is_a_fault_until_it_answers(graph: Graph, node: ClumsyNode) -> None:
    for _ in range(IN_A_ROW):
        graph.call(shared.STOP_ARM, StopArm.Request())
    assert f"{shared.STOP_ARM.name} has failed {IN_A_ROW} times in a row" in str(node.health.faults)
    graph.call(shared.STOP_ARM, StopArm.Request(reason="now"))
    assert not node.health.faults
