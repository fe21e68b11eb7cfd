"""The newest message of each of some topics, as values of the core.

It is what a task looks at. A message that cannot be used is counted and reported, and never replaces a good
one.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

from pack_core.ros.contracts.contract import Contract
from pack_core.ros.node import CellNode
from pack_core.ros.stream import NodeThread, Stream, StreamWait

READ_PERIOD = 0.05
"""Longest time between two checks by the thread of what has come [s of wall clock]."""
REST = 0.05
"""Time for which the thread looks at nothing while the node has no goal [s of wall clock]."""


@dataclass(frozen=True)
class Kept:
    """A topic whose newest message is kept.

    Attributes:
        contract: the topic.
        convert: makes a value of a message, or refuses it by a PackError.
        depth: messages that may wait; None: as the contract has it.
        raw: `convert` takes the message as the bytes that came (CDR).
    """

    contract: Contract
    convert: Callable[[Any], Any]
    depth: int | None = None
    raw: bool = False


class NewestMessages:
    """Keeps what was heard last. Messages wait in the middleware until they are looked at (`refresh`).

    Where more came than may wait, the oldest are dropped unseen. Any thread may look.

    Args:
        node: whose messages are kept.
        kept: the topics, in the sequence in which they are looked at. For messages of the last one `wait`
            waits.
    """

    def __init__(self, node: CellNode, kept: Sequence[Kept]) -> None:
        self._node, self._awaited = node, kept[-1].contract.name
        self._values: dict[str, Any] = {}
        self._lock = threading.Lock()
        self._thread: NodeThread | None = None
        self._on_awaited: Callable[[], None] = lambda: None
        self._streams = [
            (
                Stream(node, one.contract, depth=one.depth, raw=one.raw),
                partial(self._keep, one.contract.name, one.convert),
            )
            for one in kept
        ]
        self._wait = StreamWait(node, (self._streams[-1][0],))

    def __getitem__(self, contract: Contract) -> Any:
        """The newest value of a topic; None before the first."""
        return self._values.get(contract.name)

    def until(self, contract: Contract, time: float) -> Any:
        """The newest value of a topic, which has a time; None while that is ahead of `time` [s].

        The simulator has begun anew then, and what was seen before counts no more.
        """
        value = self[contract]
        return value if value is not None and value.time <= time else None

    def wait(self, timeout: float) -> bool:
        """Whether a message of the last topic has come within `timeout` [s of wall clock]."""
        return self._wait.wait(timeout)

    def refresh(self) -> None:
        """Take all that has come."""
        with self._lock:
            for stream, keep in self._streams:
                for message in stream.take_all():
                    self._node.guard(stream.contract, keep, message)

    def follow(self, on_awaited: Callable[[], None]) -> None:
        """Look by a thread of its own from now on; `on_awaited` is called after each of the last topic.

        While the node has no goal the thread looks at the newest messages twenty times a second only.
        """
        self._on_awaited = on_awaited
        self._thread = NodeThread(self._node, self._turn, "stream reader")

    def end(self) -> None:
        """Let the thread look no more."""
        if self._thread is not None:
            self._thread.end()

    def _turn(self) -> None:
        if not self._node.is_busy:
            time.sleep(REST)
        self.wait(READ_PERIOD)
        self.refresh()

    def _keep(self, name: str, convert: Callable[[Any], Any], message: Any) -> None:
        self._values[name] = convert(message)
        if name == self._awaited:
            self._on_awaited()
