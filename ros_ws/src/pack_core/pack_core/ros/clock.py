"""Simulated time that costs next to nothing, and the check of stamps against it."""

from __future__ import annotations

import math
import threading
from collections.abc import Callable
from contextlib import suppress
from typing import Any

from rclpy.callback_groups import CallbackGroup
from rclpy.exceptions import InvalidHandle
from rclpy.node import Node
from rclpy.subscription import Subscription
from rosgraph_msgs.msg import Clock

from pack_core import stamps
from pack_core.errors import MessageError

AHEAD = 0.5
"""How far a stamp may be ahead of the clock [s]; a tick of /clock may come later than what it stamps."""


class TakenByHand(CallbackGroup):
    """Keeps its subscriptions out of the executor: whoever made them takes the messages."""

    def can_execute(self, entity: Any) -> bool:
        """Never."""
        return False

    def beginning_execution(self, entity: Any) -> bool:
        """Never."""
        return False

    def ending_execution(self, entity: Any) -> None:
        """Nothing began."""


class SimulatedTime:
    """Takes the ticks that wait and sets the node's clock.

    Under `use_sim_time` rclpy would have the executor call back for every tick, 50 times a second.

    Args:
        ticks: rclpy's subscription to /clock, which no executor serves.
        note: is told, in words, of a tick that is wrong.
    """

    def __init__(self, ticks: Subscription, note: Callable[[str], None]) -> None:
        self._ticks, self._note = ticks, note
        self._last_ns = 0
        self._lock = threading.Lock()  # of two threads that ask, one would set the clock back

    def update(self) -> None:
        """Set the node's clock to the last tick that has come."""
        ticks = self._ticks
        with self._lock, suppress(InvalidHandle), ticks.handle:  # it ends when `use_sim_time` is set to false
            while (item := ticks.handle.take_message(ticks.msg_type, False)) is not None:
                self._set(item[0])

    def _set(self, tick: Clock) -> None:
        time_ns = tick.clock.sec * stamps.NS_PER_S + tick.clock.nanosec
        if time_ns < 0:
            self._note(f"time {stamps.to_seconds(time_ns):.3f} s; allowed: from 0 on")
            return
        if time_ns < self._last_ns:
            was, now = stamps.to_seconds(self._last_ns), stamps.to_seconds(time_ns)
            self._note(f"time went back from {was:.3f} s to {now:.3f} s: has the simulator begun anew?")
        self._last_ns = time_ns
        self._ticks.callback(tick)


class StampCheck:
    """Compares the stamps of one topic with the node's clock, as soon as one leaps ahead of those before it.

    Args:
        node: whose clock counts.
    """

    def __init__(self, node: Node) -> None:
        self._node = node
        self._last = -math.inf

    def check(self, time: float) -> None:
        """Look at the stamp of a message [s].

        Raises:
            MessageError: it is in the future.
        """
        # The clock is asked only then, because asking takes longer than most messages do.
        if time > self._last + AHEAD:
            now = stamps.to_seconds(self._node.get_clock().now().nanoseconds)
            if time > now + AHEAD:
                raise MessageError(
                    f"stamped {time:.3f} s, {time - now:.3f} s in the future; allowed: {AHEAD} s ahead of "
                    f"the clock, which is at {now:.3f} s"
                )
        self._last = time
