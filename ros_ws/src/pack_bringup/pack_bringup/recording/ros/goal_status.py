"""Whether a goal is in progress, from the status topic that every ROS 2 action has."""

from __future__ import annotations

from action_msgs.msg import GoalStatus, GoalStatusArray
from rclpy.qos import qos_profile_action_status_default
from rclpy.serialization import deserialize_message

from pack_core.ros.contracts.contract import Contract, Kind
from pack_core.ros.contracts.table import wiring_of

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
