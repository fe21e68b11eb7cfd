"""Topics of the wiring tables as bags describe them."""

from __future__ import annotations

from rclpy.qos import DurabilityPolicy, QoSProfile
from rosbags.interfaces import Qos, QosDurability, QosHistory, QosLiveliness, QosReliability, QosTime

from pack_core.ros.contracts.contract import Contract
from pack_evaluation.raw_bag import Topic

FOREVER = QosTime(9223372036, 854775807)
"""How ROS 2 writes that a deadline, lifespan or lease never ends."""


def is_latched(contract: Contract) -> bool:
    """Whether a late listener is sent the topic's newest message."""
    assert contract.qos is not None, f"{contract.name} is no topic"
    return bool(contract.qos.durability == DurabilityPolicy.TRANSIENT_LOCAL)


def to_bag_topic(contract: Contract) -> Topic:
    """A topic of the wiring tables as a bag describes it."""
    package = contract.type.__module__.split(".")[0]
    return Topic(contract.name, f"{package}/msg/{contract.type.__name__}", (_offered(contract.qos),))


def _offered(qos: QoSProfile) -> Qos:
    return Qos(
        history=QosHistory(qos.history), depth=qos.depth,
        reliability=QosReliability(qos.reliability), durability=QosDurability(qos.durability),
        deadline=FOREVER, lifespan=FOREVER,
        liveliness=QosLiveliness(qos.liveliness), liveliness_lease_duration=FOREVER,
        avoid_ros_namespace_conventions=False,
    )  # fmt: skip
