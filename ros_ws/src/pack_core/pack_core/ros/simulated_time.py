"""The time of /clock, read when somebody asks for it."""

from __future__ import annotations

import threading
from contextlib import suppress

from rclpy.exceptions import InvalidHandle
from rclpy.subscription import Subscription
from rosgraph_msgs.msg import Clock

from pack_core import stamps
from pack_core.ros.contracts.shared import CLOCK
from pack_core.ros.guarded_node import GuardedNode


class SimulatedTime:
    """Takes the ticks that wait and sets the node's clock.

    Under `use_sim_time` rclpy would have the executor call back for every tick, 250 times a second.

    Args:
        node: whose clock it is.
        ticks: rclpy's subscription to /clock, which no executor serves.
    """

    def __init__(self, node: GuardedNode, ticks: Subscription) -> None:
        self._node, self._ticks = node, ticks
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

    def _note(self, trouble: str) -> None:
        self._node.health.count(f"refused {CLOCK.name}", trouble)
        self._node.get_logger().warning(f"{CLOCK.name}: {trouble}", throttle_duration_sec=1.0)
