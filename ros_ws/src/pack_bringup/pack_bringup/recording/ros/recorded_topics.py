"""What the recorder listens to: topics and message definitions as bags have them, and the status of goals."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

from action_msgs.msg import GoalStatus, GoalStatusArray
from ament_index_python.packages import get_package_share_directory
from rclpy.qos import QoSProfile
from rclpy.serialization import deserialize_message
from rosbags.interfaces import Qos, QosDurability, QosHistory, QosLiveliness, QosReliability, QosTime
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from rosbags.typesys.store import Typestore

from pack_core.bag_topic import Topic
from pack_core.ros.contracts.contract import Contract, Kind, goal_states_of
from pack_core.ros.contracts.table import wiring_of

INTERFACES = "pack_interfaces"


def message_types() -> Typestore:
    """All types that the cells' topics and services use, for whole schemas and type hashes."""
    types = get_typestore(Stores.ROS2_JAZZY)
    share = Path(get_package_share_directory(INTERFACES))
    for path in sorted(share.glob("msg/*.msg")):
        types.register(get_types_from_msg(path.read_text(), f"{INTERFACES}/msg/{path.stem}"))
    for path in sorted(share.glob("srv/*.srv")):
        for name, text in _parts_of(f"{INTERFACES}/msg/{path.stem}", path.read_text()):
            types.register(get_types_from_msg(text, name))
    return types


def _parts_of(service: str, text: str) -> Iterator[tuple[str, str]]:
    """Names and definitions of a service's request, answer and event.

    They are described as messages of the same content, because rosbags reads and writes no others.
    """
    request, answer = re.split(r"^---$", text, maxsplit=1, flags=re.MULTILINE)
    yield f"{service}_Request", request
    yield f"{service}_Response", answer
    event = f"{service}_Request[<=1] request\n{service}_Response[<=1] response\n"
    yield f"{service}_Event", f"service_msgs/ServiceEventInfo info\n{event}"


FOREVER = QosTime(9223372036, 854775807)
"""How ROS 2 writes that a deadline, lifespan or lease never ends."""


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
    """The status topic of each action of a cell's nodes; its sources are the nodes that pursue the goals.

    The action of a driver's controller is none of them: its goals are pieces of a move.
    """
    return tuple(
        goal_states_of(action, "recorder")
        for action in wiring_of(cell)
        if action.kind is Kind.ACTION and "user" not in action.targets
    )


class GoalsInProgress:
    """Which of a cell's actions have a goal in progress; true while one has.

    Args:
        contracts: the actions' status topics.
    """

    def __init__(self, contracts: tuple[Contract, ...]) -> None:
        self._servers = {contract.name: contract.sources for contract in contracts}
        self._active_ns: dict[str, int] = {}
        self._lost_ns: dict[str, int] = {}

    def __bool__(self) -> bool:
        return any(
            sent_ns > max(self._lost_ns.get(server, -1) for server in self._servers[topic])
            for topic, sent_ns in self._active_ns.items()
        )

    def on_status(self, topic: str, sent_ns: int, data: bytes) -> None:
        """Take in a message of a status topic in CDR form, sent at `sent_ns` [ns of wall clock]."""
        found = deserialize_message(data, GoalStatusArray)
        if any(item.status in IN_PROGRESS for item in found.status_list):
            self._active_ns[topic] = sent_ns
        else:
            self._active_ns.pop(topic, None)

    def on_lost_node(self, node: str, now_ns: int) -> None:
        """A node has ended: the goals that it pursued have ended with it, and it cannot say so any more.

        What it sent before may still be on its way, so a status counts only if it was sent after `now_ns`
        [ns of wall clock]. May be called from another thread than the rest.
        """
        self._lost_ns[node] = now_ns
