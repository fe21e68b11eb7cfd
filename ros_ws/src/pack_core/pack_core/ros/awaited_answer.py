"""A service's answer that no goal waits for in vain.

The middleware loses the answer of a server that has only just started: its service is called ready as soon as
the client has heard of both its ends, which is before the server has heard of the client.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

from rclpy.client import Client
from rclpy.executors import Executor
from rclpy.node import Node
from rclpy.task import Future

from pack_core.errors import PackError

PATIENCE = (5.0, 10.0, 30.0)
"""How long one request after the other is waited for [s of wall clock]: a slow server is asked few times."""
ONCE = (5.0,)
"""The same for a request that must not be carried out a second time, later."""


class AwaitedAnswer:
    """Asks, asks again where no answer comes, and gives up at last.

    Args:
        ask: sends the request.
        name: of the service.
        patience: how long each request is waited for [s of wall clock].
        now: the steady clock [s].
        executor: of the node that waits.

    Attributes:
        future: holds the answer; a PackError where there is none.
    """

    def __init__(
        self,
        ask: Callable[[], Future],
        name: str,
        patience: Sequence[float],
        now: float,
        executor: Executor | None,
    ) -> None:
        self._ask, self._name, self._patience, self._left = ask, name, sum(patience), list(patience)
        self.future = Future(executor=executor)
        self._ask_until(now)

    def give_up(self, reason: str) -> None:
        """Wait no longer."""
        if not self.future.done():
            self.future.set_exception(PackError(reason))

    def check(self, now: float) -> None:
        """Ask again where it is time; to be called again and again with the steady clock [s]."""
        if self.future.done() or now < self._until:
            return
        if self._left:
            self._ask_until(now)
        else:
            self.give_up(f"no answer from {self._name} in {self._patience:.0f} s")

    def _ask_until(self, now: float) -> None:
        self._until = now + self._left.pop(0)
        self._ask().add_done_callback(self._take)

    def _take(self, answered: Future) -> None:
        if not self.future.done():
            self.future.set_result(answered.result())


class ServiceAnswers:
    """The answer that a node's goal waits for, one at a time.

    Args:
        node: pursues the goal.
    """

    def __init__(self, node: Node) -> None:
        self._node = node
        self._awaited: AwaitedAnswer | None = None

    async def of(self, client: Client, request: Any, patience: Sequence[float] = PATIENCE) -> Any:
        """Wait for a service's answer.

        Args:
            client: of the service.
            request: is sent again where no answer comes, so it may be carried out more than once.
            patience: how long each of these requests is waited for [s of wall clock].

        Raises:
            PackError: none came, or the goal is to end before it.
        """
        ask, now = partial(client.call_async, request), time.monotonic()
        self._awaited = awaited = AwaitedAnswer(ask, client.srv_name, patience, now, self._node.executor)
        try:
            return await awaited.future
        finally:
            self._awaited = None

    def check(self, now: float, *, is_cancelled: bool) -> None:
        """Ask again where it is time by the steady clock [s], and wait no longer for a cancelled goal."""
        if self._awaited is not None:
            self._awaited.check(now)
        if is_cancelled:
            self.give_up("canceled on request")

    def give_up(self, reason: str) -> None:
        """Let `of` end with the reason, where it waits."""
        if self._awaited is not None:
            self._awaited.give_up(reason)
