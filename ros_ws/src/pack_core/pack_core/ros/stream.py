"""Subscriptions that are read when there is use for them, instead of one callback for every message.

The executor of rclpy takes about 0.4 ms of processor time for a message, whatever its callback does: 500
joint states a second are 20 % of a core. Reading a subscription without it takes a twentieth of that.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Sequence
from typing import Any

from rclpy.event_handler import EventHandler, QoSSubscriptionEventType
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.node import Node
from rclpy.qos import QoSProfile

from pack_core.ros.clock import TakenByHand
from pack_core.ros.contracts.contract import Contract
from pack_core.ros.node import CellNode

PAUSE = 0.05
"""After a turn that failed [s of wall clock], so that one that always fails does not take a whole core."""


class Stream:
    """A subscription whose messages wait in the middleware until they are taken; any thread may take them.

    Args:
        node: who subscribes.
        contract: the topic.
        depth: messages that may wait, the oldest being dropped; None: as the contract has it.
        raw: hand out messages as the bytes that came (CDR) instead of building them.
        on_match: called by whoever waits for the stream (`StreamWait`) when a publisher has met it, before
            its first message is taken, or left it.
    """

    def __init__(
        self, node: Node, contract: Contract, *, depth: int | None = None, raw: bool = False,
        on_match: Callable[[], None] | None = None,
    ) -> None:  # fmt: skip
        assert contract.qos is not None, f"{contract.name} is no topic"
        self.contract = contract
        qos = QoSProfile(
            depth=depth or contract.qos.depth,
            reliability=contract.qos.reliability,
            durability=contract.qos.durability,
        )
        self._node, self._type, self._is_raw = node, contract.type, raw
        self._subscription = node.create_subscription(
            contract.type, contract.name, lambda _: None, qos, callback_group=TakenByHand(), raw=raw
        )
        self._on_match, self.matches = on_match, self._match_events() if on_match else ()

    @property
    def topic_name(self) -> str:
        """The topic's name with its namespace."""
        return str(self._subscription.topic_name)

    @property
    def handle(self) -> Any:
        """What a wait set of rclpy waits for."""
        return self._subscription.handle

    def close(self) -> None:
        """Listen no longer."""
        self._node.destroy_subscription(self._subscription)

    def take_all(self) -> list[Any]:
        """All messages that wait, oldest first."""
        return [message for _, message in self.take_with_times()]

    def take_with_times(self) -> list[tuple[int, Any]]:
        """All messages that wait, each with the time at which it was sent [ns of wall clock]."""
        taken, handle = [], self._subscription.handle
        with handle:
            while (item := handle.take_message(self._type, self._is_raw)) is not None:
                taken.append((item[1]["source_timestamp"], item[0]))
        return taken

    def look_for_matches(self, wait_set: Any) -> None:
        """Call `on_match` if the wait set says that publishers have come or gone."""
        for event in self.matches:
            if event.is_ready(wait_set):
                event.take_data()
                assert self._on_match is not None
                self._on_match()

    def _match_events(self) -> tuple[EventHandler, ...]:
        event = EventHandler(
            callback_group=TakenByHand(),
            callback=lambda _: None,
            event_type=QoSSubscriptionEventType.RCL_SUBSCRIPTION_MATCHED,
            parent_impl=self._subscription.handle,
        )
        # Both, so that it ends with the subscription; the executor does not wait for what is taken by hand.
        self._subscription.event_handlers.append(event)
        self._node.add_waitable(event)
        return (event,)


class StreamWait:
    """Waits until one of some streams has a message, outside the executor."""

    def __init__(self, node: Node, streams: Sequence[Stream]) -> None:
        self._streams = streams
        events = sum(len(stream.matches) for stream in streams)
        self._wait_set = rclpy_implementation.WaitSet(len(streams), 0, 0, 0, 0, events, node.context.handle)

    def wait(self, timeout: float) -> bool:
        """Whether a message has come within `timeout` [s of wall clock]."""
        self._wait_set.clear_entities()
        for stream in self._streams:
            self._wait_set.add_subscription(stream.handle)
            for event in stream.matches:
                event.add_to_wait_set(self._wait_set)
        self._wait_set.wait(int(timeout * 1e9))
        for stream in self._streams:
            stream.look_for_matches(self._wait_set)
        return bool(self._wait_set.get_ready_entities("subscription"))


class NodeThread:
    """A thread of a node that takes one turn after the other until it is ended.

    What a turn raises is counted and named, as what a callback raises is; the next turn comes a little later.

    Args:
        node: is told of an error.
        turn: is called again and again; it should return at least every 0.1 s.
        name: of the thread.
    """

    def __init__(self, node: CellNode, turn: Callable[[], None], name: str) -> None:
        self._node, self._turn, self._name = node, turn, name
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._run, name=name, daemon=True)
        self._thread.start()

    def end(self) -> None:
        """Return when the last turn is over."""
        self._ended.set()
        self._thread.join()

    def _run(self) -> None:
        while not self._ended.is_set() and self._node.context.ok():
            try:
                self._turn()
            except Exception as error:
                if not self._ended.is_set():
                    self._node.fail(self._name, error)
                    self._ended.wait(PAUSE)
            else:
                self._node.failures.passed(self._name)


class StreamReader(NodeThread):
    """Calls `read` in a thread of its own whenever a stream has a message, and at least once a `period`.

    Args:
        node: as of `NodeThread`.
        streams: those that are waited for.
        read: takes what has come.
        period: longest time between two calls [s of wall clock].
    """

    def __init__(
        self, node: CellNode, streams: Sequence[Stream], read: Callable[[], None], period: float
    ) -> None:
        wait = StreamWait(node, streams)

        def turn() -> None:
            wait.wait(period)
            read()

        super().__init__(node, turn, "stream reader")
