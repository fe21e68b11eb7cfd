"""Live topics over Foxglove's protocol, as a client on this machine gets them."""

from __future__ import annotations

import socket
from collections.abc import Iterator
from typing import Any

import pytest
from std_msgs.msg import Float64

from integration.foxglove_client import FoxgloveClient
from integration.harness import Graph
from pack_bringup.foxglove_node import FoxgloveNode
from pack_bringup.recording.ros.recorded_topics import message_types
from pack_core.ros.contracts import shared
from pack_core.ros.contracts.contract import Kind
from pack_core.ros.contracts.table import wiring_of

pytest.importorskip("foxglove", reason="an extra: see docs/operate/rviz_and_foxglove.md")


@pytest.fixture
def port() -> int:
    """One that is free."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


@pytest.fixture
def node(graph: Graph, port: int) -> FoxgloveNode:
    return graph.start(FoxgloveNode, cell="blocks", port=port)


@pytest.fixture
def client(node: FoxgloveNode, port: int) -> Iterator[FoxgloveClient]:
    opened = FoxgloveClient(shared.REAL_TIME_FACTOR.name, port)
    yield opened
    opened.close()


def test_a_client_sees_every_topic_and_gets_the_bytes_of_those_that_it_wants(
    graph: Graph, node: FoxgloveNode, client: FoxgloveClient
) -> None:
    def heard() -> bool:
        graph.probe.send(shared.REAL_TIME_FACTOR, Float64(data=0.75))
        return bool(client.payloads)

    graph.wait_until(heard)
    topics = {contract.name for contract in wiring_of("blocks") if contract.kind is Kind.TOPIC}
    assert set(client.channels) == topics
    assert {channel["encoding"] for channel in client.channels.values()} == {"cdr"}
    message: Any = message_types().deserialize_cdr(client.payloads[0], "std_msgs/msg/Float64")
    assert message.data == 0.75
    assert [topic.is_heard for topic in node.topics].count(True) == 1
    client.close()
    graph.wait_until(lambda: not any(topic.is_heard for topic in node.topics))


def test_a_client_may_read_only(graph: Graph, client: FoxgloveClient) -> None:
    graph.wait_until(lambda: client.info)
    assert client.info["capabilities"] == ["time"]
