"""Base of every node: endpoints from the wiring table, health, and watch over its peers."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray
from rclpy.clock import Clock, ClockType
from rclpy.duration import Duration
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import LivelinessPolicy, QoSProfile
from rclpy.subscription import Subscription
from std_msgs.msg import Empty

from pack_core.errors import PackError
from pack_core.ros import contracts
from pack_core.ros.contracts import Contract
from pack_core.ros.health import Health

LEASE = Duration(seconds=0.1)
"""A node is dead when the middleware has not heard of it for this long, in wall clock. A shorter
lease sees deaths sooner, and takes a node that waits for a busy machine's processor for dead."""


def _alive_qos() -> QoSProfile:
    return QoSProfile(depth=1, liveliness=LivelinessPolicy.AUTOMATIC, liveliness_lease_duration=LEASE)


class CellNode(Node):
    """A node whose endpoints come from the wiring table and that survives every message."""

    def __init__(self, name: str, **kwargs: Any) -> None:
        super().__init__(name, **kwargs)
        self.health = Health(name)
        self._diagnostics = self.advertise(contracts.DIAGNOSTICS)
        self._alive = self.create_publisher(Empty, f"/alive/{name}", _alive_qos())
        self.wall = Clock(clock_type=ClockType.STEADY_TIME)
        self.create_timer(1.0, self.report, clock=self.wall)

    def advertise(self, contract: Contract) -> Publisher:
        """A publisher of the contract's topic."""
        return self.create_publisher(contract.type, contract.name, contract.qos)

    def listen(self, contract: Contract, callback: Callable[[Any], None], **kwargs: Any) -> Subscription:
        """A subscription that drops, counts and reports a message its callback refuses."""

        def guarded(message: Any) -> None:
            try:
                callback(message)
            except PackError as error:
                self.health.count(f"refused {contract.name}", str(error))
                self.get_logger().warning(f"refused {contract.name}: {error}", throttle_duration_sec=1.0)

        return self.create_subscription(contract.type, contract.name, guarded, contract.qos, **kwargs)

    def watch(self, peers: Iterable[str], on_change: Callable[[str, bool], None] | None = None) -> None:
        """Report peers that die; `on_change(peer, is_alive)` is called when one dies or comes (back)."""
        for peer in peers:
            self._watch(peer, on_change)

    def _watch(self, peer: str, on_change: Callable[[str, bool], None] | None) -> None:
        def changed(event: Any) -> None:
            is_alive = event.alive_count > 0
            if is_alive:
                self.health.faults.pop(peer, None)
            else:
                self.health.faults[peer] = f"node '{peer}' is silent: restart it (pack run, or pack up)"
                self.get_logger().error(self.health.faults[peer])
                self.report()
            if on_change:
                on_change(peer, is_alive)

        self.create_subscription(
            Empty, f"/alive/{peer}", lambda _: None, _alive_qos(),
            event_callbacks=SubscriptionEventCallbacks(liveliness=changed),
        )  # fmt: skip

    def report(self) -> None:
        """Publish this node's health."""
        message = DiagnosticArray(status=[self.health.status()])
        message.header.stamp = self.get_clock().now().to_msg()
        self._diagnostics.publish(message)
