"""A client of Foxglove's protocol, as the app is one."""

from __future__ import annotations

import asyncio
import json
import struct
import threading
from typing import Any

from websockets.asyncio.client import ClientConnection, connect

PROTOCOL = "foxglove.sdk.v1"
MESSAGE = struct.Struct("<BIQ")
"""A message to a client: opcode 1, number of the subscription, time [ns]; the payload follows."""


class FoxgloveClient:
    """Subscribes to one topic, and keeps what it is sent.

    Attributes:
        info: what the server says of itself.
        channels: by topic.
        payloads: messages of the topic.
        said: kinds of everything that the server has said.
    """

    def __init__(self, topic: str, port: int) -> None:
        self.info: dict[str, Any] = {}
        self.said: set[str] = set()
        self.channels: dict[str, dict[str, Any]] = {}
        self.payloads: list[bytes] = []
        self._topic, self._ended = topic, threading.Event()
        self._address = f"ws://127.0.0.1:{port}"
        self._thread = threading.Thread(target=lambda: asyncio.run(self._follow()), daemon=True)
        self._thread.start()

    def wait(self, time: float) -> None:
        """Let messages come for a while [s]."""
        self._ended.wait(time)

    def close(self) -> None:
        """End the connection."""
        self._ended.set()
        self._thread.join()

    async def _follow(self) -> None:
        async with connect(self._address, subprotocols=[PROTOCOL]) as socket:
            while not self._ended.is_set():
                try:
                    message = await asyncio.wait_for(socket.recv(), 0.05)
                except TimeoutError:
                    continue
                if isinstance(message, bytes):
                    self._take(message)
                else:
                    await self._answer(socket, json.loads(message))

    async def _answer(self, socket: ClientConnection, command: dict[str, Any]) -> None:
        self.said.add(command["op"])
        if command["op"] == "serverInfo":
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
