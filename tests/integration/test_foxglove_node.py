"""Live topics over Foxglove's protocol, as a client on this machine gets them."""

from __future__ import annotations

import asyncio
import json
import struct
import threading
from collections.abc import Iterator
from typing import Any

import pytest
from std_msgs.msg import Float64

from integration.harness import Graph
from pack_bringup.foxglove_node import FoxgloveNode
from pack_bringup.recording.message_types import message_types
from pack_core.ros.contracts import shared
from pack_core.ros.contracts.contract import Kind
from pack_core.ros.contracts.table import wiring_of

pytest.importorskip("foxglove", reason="an extra: see docs/rviz_and_foxglove.md")
connect = pytest.importorskip("websockets.asyncio.client").connect

PORT = 18765
PROTOCOL = "foxglove.sdk.v1"
MESSAGE = struct.Struct("<BIQ")
"""A message to a client: opcode 1, number of the subscription, time [ns]; the payload follows."""


class Client:
    """Subscribes to one topic, and keeps what it is sent."""

    def __init__(self, topic: str) -> None:
        self.info: dict[str, Any] = {}
        self.channels: dict[str, dict[str, Any]] = {}
        self.payloads: list[bytes] = []
        self._topic, self._ended = topic, threading.Event()
        self._thread = threading.Thread(target=lambda: asyncio.run(self._follow()), daemon=True)
        self._thread.start()

    def close(self) -> None:
        self._ended.set()
        self._thread.join()

    async def _follow(self) -> None:
        async with connect(f"ws://127.0.0.1:{PORT}", subprotocols=[PROTOCOL]) as socket:
            while not self._ended.is_set():
                try:
                    message = await asyncio.wait_for(socket.recv(), 0.05)
                except TimeoutError:
                    continue
                if isinstance(message, bytes):
                    self._take(message)
                elif (command := json.loads(message))["op"] == "serverInfo":
                    self.info = command
                elif command["op"] == "advertise":
                    self.channels |= {channel["topic"]: channel for channel in command["channels"]}
                    if self._topic in self.channels:
                        wanted = {"id": 7, "channelId": self.channels[self._topic]["id"]}
                        await socket.send(json.dumps({"op": "subscribe", "subscriptions": [wanted]}))

    def _take(self, message: bytes) -> None:
        opcode, number, _ = MESSAGE.unpack_from(message) if len(message) >= MESSAGE.size else (0, 0, 0)
        if (opcode, number) == (1, 7):
            self.payloads.append(message[MESSAGE.size :])


@pytest.fixture
def node(graph: Graph) -> FoxgloveNode:
    return graph.start(FoxgloveNode, cell="blocks", port=PORT)


@pytest.fixture
def client(node: FoxgloveNode) -> Iterator[Client]:
    opened = Client(shared.REAL_TIME_FACTOR.name)
    yield opened
    opened.close()


def test_a_client_sees_every_topic_and_gets_the_bytes_of_those_that_it_wants(
    graph: Graph, node: FoxgloveNode, client: Client
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


def test_a_client_may_read_only(graph: Graph, client: Client) -> None:
    graph.wait_until(lambda: client.info)
    assert client.info["capabilities"] == ["time"]
