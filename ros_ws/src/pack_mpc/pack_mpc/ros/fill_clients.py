"""The services that a fill job uses, and what their answers say."""

from __future__ import annotations

from typing import Any

from pack_interfaces.srv import PlanFilling
from rclpy.task import Future

from pack_core.errors import MessageError
from pack_core.packing.goals import Arrangement
from pack_core.ros.contracts import packing as contracts
from pack_core.ros.contracts.contract import Contract
from pack_core.ros.messages.conversions import from_pose
from pack_core.ros.node import CellNode


class FillClients:
    """Clients of the services that a fill job uses."""

    def __init__(self, node: CellNode) -> None:
        self._clients = {
            contract.name: node.create_client(contract.type, contract.name)
            for contract in (
                contracts.PLAN_FILLING, contracts.PRESENT, contracts.PLAN_PLACEMENT,
                contracts.GRIPPER_COMMAND,
            )
        }  # fmt: skip

    def call(self, contract: Contract, request: Any) -> Future:
        """Send a request."""
        return self._clients[contract.name].call_async(request)


def reason_in(response: Any) -> str:
    """Why a request was refused; empty if it was not."""
    return "" if response.success else (response.message or "refused without a reason")


def arrangement_in(response: PlanFilling.Response) -> Arrangement:
    """The arrangement in a response.

    Raises:
        MessageError: the planner refused the request, or a pose cannot be used.
    """
    if not response.success:
        raise MessageError(f"{contracts.PLAN_FILLING.name}: {response.message}")
    if len(response.placed) != len(response.poses) or len(response.refused) != len(response.reasons):
        raise MessageError(f"{contracts.PLAN_FILLING.name}: names and poses, or reasons, differ in number")
    placed = dict(zip(response.placed, map(from_pose, response.poses), strict=True))
    refused = dict(zip(response.refused, response.reasons, strict=True))
    return Arrangement(tuple(response.order), placed, refused)
