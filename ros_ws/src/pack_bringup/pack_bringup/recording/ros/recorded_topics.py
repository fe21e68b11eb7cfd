"""What the recorder listens to: topics and message definitions as bags have them, and the status of goals."""

from __future__ import annotations

from pathlib import Path

from action_msgs.msg import GoalStatus, GoalStatusArray
from ament_index_python.packages import get_package_share_directory
from rclpy.qos import DurabilityPolicy, QoSProfile, qos_profile_action_status_default
from rclpy.serialization import deserialize_message
from rosbags.interfaces import Qos, QosDurability, QosHistory, QosLiveliness, QosReliability, QosTime
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from rosbags.typesys.store import Typestore

from pack_core.bag_topic import Topic
from pack_core.ros.contracts.contract import Contract, Kind
from pack_core.ros.contracts.table import wiring_of

INTERFACES = "pack_interfaces"


def message_types() -> Typestore:
    """All types that the cells' topics use, for whole schemas and type hashes."""
    types = get_typestore(Stores.ROS2_JAZZY)
    folder = Path(get_package_share_directory(INTERFACES), "msg")
    for path in sorted(folder.glob("*.msg")):
        types.register(get_types_from_msg(path.read_text(), f"{INTERFACES}/msg/{path.stem}"))
    return types


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


IN_PROGRESS = {GoalStatus.STATUS_ACCEPTED, GoalStatus.STATUS_EXECUTING, GoalStatus.STATUS_CANCELING}


def status_contracts(cell: str) -> tuple[Contract, ...]:
    """The status topic of each of a cell's actions; its sources are the nodes that pursue the goals."""
    return tuple(
        Contract(
            f"{action.name}/_action/status", GoalStatusArray, action.targets, ("recorder",),
            "state of each goal", qos=qos_profile_action_status_default,
        )
        for action in wiring_of(cell)
        if action.kind is Kind.ACTION
    )  # fmt: skip


class GoalsInProgress:
    """Which of a cell's actions have a goal in progress; true while one has.

    Args:
        contracts: the actions' status topics.
    """

    def __init__(self, contracts: tuple[Contract, ...]) -> None:
        self._servers = {contract.name: contract.sources for contract in contracts}
        self._active: set[str] = set()

    def __bool__(self) -> bool:
        return bool(self._active)

    def __contains__(self, topic: str) -> bool:
        return topic in self._servers

    def on_status(self, topic: str, data: bytes) -> None:
        """Take in a message of a status topic, in CDR form."""
        found = deserialize_message(data, GoalStatusArray)
        if any(item.status in IN_PROGRESS for item in found.status_list):
            self._active.add(topic)
        else:
            self._active.discard(topic)

    def on_lost_node(self, node: str) -> None:
        """A node has ended: the goals that it pursued have ended with it, and it cannot say so any more."""
        self._active -= {topic for topic, servers in self._servers.items() if node in servers}
