"""A client of OPC UA in a thread of its own, so that the graph can be spun while it waits."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Coroutine
from typing import Any

from asyncua import Client, ua

from integration.harness import Graph

PREFIX = "ns=2;s=Cell"


class OpcUaClient:
    """Reads, calls and listens as a PLC does.

    Args:
        graph: is spun while the client waits.
        url: of the server.

    Attributes:
        events: alarms that have come: condition's name, whether it is active, and the message.
    """

    def __init__(self, graph: Graph, url: str, **security: Any) -> None:
        self._graph = graph
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._loop.run_forever, daemon=True)
        self._thread.start()
        self.client = Client(url)
        self.events: list[tuple[str, bool, str]] = []
        if security:
            self.client.application_uri = security["uri"]
            self.run(self.client.set_security_string(security["string"]))
        self.run(self.client.connect())

    def run(self, work: Coroutine[Any, Any, Any]) -> Any:
        """What a coroutine of asyncua returns."""
        future = asyncio.run_coroutine_threadsafe(work, self._loop)
        self._graph.wait_until(future.done)
        return future.result()

    def read(self, path: str) -> Any:
        """A value."""
        return self.run(self.client.get_node(f"{PREFIX}.{path}").read_value())

    def wait_for(self, path: str, value: Any) -> None:
        """Wait until a value is this one."""
        self._graph.wait_until(lambda: self.read(path) == value)

    def call(self, method: str, *arguments: tuple[Any, ua.VariantType]) -> tuple[bool, str]:
        """Whether a request was accepted, and why not."""
        given = [ua.Variant(value, kind) for value, kind in arguments]
        accepted, message = self.run(self.client.get_node(PREFIX).call_method(f"2:{method}", *given))
        return bool(accepted), str(message)

    def methods(self) -> list[str]:
        """Names of the requests that can be made."""
        found = self.run(self.client.get_node(PREFIX).get_methods())
        return [self.run(node.read_browse_name()).Name for node in found]

    def follow_alarms(self) -> None:
        """Collect events from now on."""

        async def subscribe() -> None:
            subscription = await self.client.create_subscription(50, self)
            node = self.client.get_node(PREFIX)
            await subscription.subscribe_events(node, ua.ObjectIds.AlarmConditionType)

        self.run(subscribe())

    def event_notification(self, event: Any) -> None:
        """Called by asyncua."""
        self.events.append((event.ConditionName, getattr(event, "ActiveState/Id"), event.Message.Text))

    def close(self) -> None:
        """Disconnect."""
        self.run(self.client.disconnect())
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join()
