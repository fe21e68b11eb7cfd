"""Publishes a recording into the live graph, so that a node runs against it as against the simulator."""

from __future__ import annotations

import importlib
import time
from collections.abc import Callable, Collection
from types import TracebackType
from typing import Any, Self

import rclpy
from rclpy.context import Context
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from rosgraph_msgs.msg import Clock

from pack_bringup.recording.playback import Playback
from pack_bringup.recording.ros.recorded_topics import message_types
from pack_core import stamps
from pack_core.bag_topic import Topic
from pack_core.errors import BagError
from pack_core.namespace import ROOT, in_cell, lifeline
from pack_core.ros.contracts import shared
from pack_core.ros.messages.conversions import to_stamp
from pack_core.ros.run import confirm_network, start_ros
from pack_core.ros.watch.peer_watch import SignOfLife
from pack_core.ros.watch.watch_socket import WatchSocket
from pack_evaluation.raw_bag import RawMessage

DEPTH = 100
"""Of topics whose recording says nothing of their quality of service."""
PATIENCE = 0.02
"""The longest sleep, and the time between two assertions that the senders are alive [s of wall clock]."""


class PlayerNode(Node):
    """Has the names of a recording below its namespace, as the nodes of a cell have them."""

    def create_publisher(self, msg_type: Any, topic: str, *args: Any, **kwargs: Any) -> Publisher:
        """As of every node."""
        return super().create_publisher(msg_type, in_cell(self.get_namespace(), topic), *args, **kwargs)


class BagPlayer:
    """A node that speaks for those that sent what was recorded; a context manager.

    Args:
        playback: what to play.
        clock: publish /clock, too, which keeps to the rate.
        stand_in: names of nodes that others shall believe to be alive meanwhile.
        domain: ROS domain; the environment's if None.
        namespace: of the cell that hears it, as rcl writes it; recordings have the names of none.

    Raises:
        BagError: a topic's message type is not installed, or is another now than when it was recorded.
    """

    def __init__(
        self, playback: Playback, *, clock: bool, stand_in: Collection[str] = (), domain: int | None = None,
        namespace: str = ROOT,
    ) -> None:  # fmt: skip
        self._playback = playback
        classes = {name: _class_of(topic, playback) for name, topic in playback.topics.items()}
        self._context = Context()
        start_ros(context=self._context, domain_id=domain)
        self._node = PlayerNode("player", context=self._context, namespace=namespace)
        confirm_network()
        self._publishers = {
            name: self._node.create_publisher(classes[name], name, _qos_of(topic))
            for name, topic in playback.topics.items()
        }
        self._clock = (
            self._node.create_publisher(Clock, shared.CLOCK.name, shared.CLOCK.qos) if clock else None
        )
        self._signs, self._given = [SignOfLife(self._node, name) for name in stand_in], 0.0
        self._watch_sockets = [
            WatchSocket(self._context.get_domain_id(), lifeline(namespace, name)) for name in stand_in
        ]

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        for watch_socket in self._watch_sockets:
            watch_socket.close()
        self._node.destroy_node()
        rclpy.try_shutdown(context=self._context)

    @property
    def unheard(self) -> list[str]:
        """Topics that nobody listens to."""
        return [name for name, p in self._publishers.items() if not p.get_subscription_count()]

    def wait_for_listeners(self, patience: float) -> list[str]:
        """Wait until somebody listens to every topic, at most `patience` [s]; those still unheard."""
        end = time.monotonic() + patience
        while self.unheard and time.monotonic() < end:
            self._give_signs()
            time.sleep(PATIENCE)
        return self.unheard

    def play(self, rate: float, on_progress: Callable[[float], None] = lambda _: None) -> int:
        """Publish everything, stamps as they were.

        Args:
            rate: simulated seconds a second.
            on_progress: is told the simulated time [s] again and again.

        Returns:
            How many messages were published.
        """
        for item in self._playback.early:
            self._publishers[item.topic].publish(item.data)
        begin, count = time.monotonic(), len(self._playback.early)
        for event in self._playback.events(clock=self._clock is not None):
            time_ns = event if isinstance(event, int) else event.time_ns
            due = begin + stamps.to_seconds(time_ns - self._playback.start_ns) / rate
            self._give_signs()
            while (early := due - time.monotonic()) > 0.0:
                time.sleep(min(early, PATIENCE))
                self._give_signs()
                on_progress(stamps.to_seconds(time_ns))
            count += self._publish(event)
        on_progress(stamps.to_seconds(self._playback.end_ns))
        return count

    def _publish(self, event: RawMessage | int) -> bool:
        """Send a message or a tick of the clock; whether it was a message."""
        if isinstance(event, int):
            assert self._clock is not None
            self._clock.publish(Clock(clock=to_stamp(stamps.to_seconds(event))))
            return False
        self._publishers[event.topic].publish(event.data)
        return True

    def _give_signs(self) -> None:
        if (now := time.monotonic()) - self._given < PATIENCE:
            return
        self._given = now
        for sign in self._signs:
            sign.give()


def _class_of(topic: Topic, playback: Playback) -> type[Any]:
    """The message class of a topic, once its definition is known to be the recorded one."""
    package, _, name = topic.type.split("/")
    try:
        found: type[Any] = getattr(importlib.import_module(f"{package}.msg"), name)
    except (ImportError, AttributeError) as error:
        raise BagError(f"{topic.name} is of type {topic.type}, which is not installed here") from error
    if playback.types.hash_rihs01(topic.type) != message_types().hash_rihs01(topic.type):
        raise BagError(
            f"{topic.type} of {topic.name} has changed since {playback.path} was recorded; play it with the "
            "version that recorded it (run.yaml says which), or leave the topic out (--topic)"
        )
    return found


def _qos_of(topic: Topic) -> QoSProfile:
    if not topic.offered_qos:
        return QoSProfile(depth=DEPTH)
    offered = topic.offered_qos[0]
    return QoSProfile(
        history=HistoryPolicy(offered.history.value), depth=offered.depth,
        reliability=ReliabilityPolicy(offered.reliability.value),
        durability=DurabilityPolicy(offered.durability.value),
    )  # fmt: skip
