"""Base of every node: simulated time that costs next to nothing, and an eye on who publishes it."""

from __future__ import annotations

from typing import Any

from rclpy.clock import Clock, ClockType
from rclpy.time_source import TimeSource

from pack_core.ros.contracts import shared
from pack_core.ros.guarded_node import GuardedNode
from pack_core.ros.simulated_time import SimulatedTime
from pack_core.ros.sole_publisher import SolePublisher
from pack_core.ros.stream import TakenByHand

CLOCKS_PERIOD = 0.2
"""How often a node looks whether there is a second simulator [s of wall clock]."""


class ClockedNode(GuardedNode):
    """A node whose clock is read when somebody asks for the time, and which knows of a second simulator.

    Attributes:
        wall: a clock of wall time that never jumps, for timers that must not wait for simulated time.
    """

    _simulated_time: SimulatedTime | None = None
    _sole_clock: SolePublisher | None = None

    def __init__(self, name: str, **kwargs: Any) -> None:
        super().__init__(name, **kwargs)
        self.wall = Clock(clock_type=ClockType.STEADY_TIME)
        self.create_timer(CLOCKS_PERIOD, self._look_at_clocks, clock=self.wall)

    def create_subscription(self, msg_type: Any, topic: str, callback: Any, *args: Any, **kwargs: Any) -> Any:
        """As of every node, but that of rclpy to /clock costs nothing until somebody asks for the time."""
        is_clock = isinstance(getattr(callback, "__self__", None), TimeSource)
        if is_clock:
            kwargs["callback_group"] = TakenByHand()
        subscription = super().create_subscription(msg_type, topic, callback, *args, **kwargs)
        if is_clock:
            self._simulated_time = SimulatedTime(self, subscription)
            self._sole_clock = SolePublisher(self, subscription.topic_name, self._on_clocks)
        return subscription

    def get_clock(self) -> Any:
        """The node's clock; under `use_sim_time` it is set to the last /clock now.

        A timer must not use it, as nobody sets it in between: `wall` is for timers.
        """
        if self._simulated_time is not None:
            self._simulated_time.update()
        return super().get_clock()

    def expect_clock_of(self, peer: str) -> None:
        """Count every /clock of a node of this name, since `forget_clock_of` will tell of its end."""
        if self._sole_clock is not None:
            self._sole_clock.track(peer)

    def forget_clock_of(self, peer: str) -> None:
        """The process of a node has ended: its /clock counts no more."""
        if self._sole_clock is not None:
            self._sole_clock.forget(peer)

    def _look_at_clocks(self) -> None:
        if self._sole_clock is not None:
            self._sole_clock.look()

    def _on_clocks(self, publishers: str) -> None:
        """While there are two clocks no stamp can be trusted: whoever commands the arm stops."""
        if not publishers:
            self.health.faults.pop(shared.CLOCK.name, None)
            return
        trouble = self.health.faults[shared.CLOCK.name] = f"a second simulator: {publishers}; end one of them"
        self.get_logger().error(trouble)
        self.react_to_failure(trouble)
