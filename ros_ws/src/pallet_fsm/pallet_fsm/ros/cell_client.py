"""Carries the machine's commands to the nodes that do them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from pack_interfaces.msg import MotionTarget
from pack_interfaces.srv import GripperCommand, RemoveBox, SpawnBox
from pack_interfaces.srv import LayOnTable as LayOnTableSrv
from rclpy.client import Client
from rclpy.task import Future
from std_srvs.srv import Trigger

from pack_core.palletizing.cell import PALLET, REORIENTATION_TABLE
from pack_core.palletizing.ports import (
    CloseGripper,
    Command,
    DiscardBox,
    LayOnTable,
    OpenGripper,
    PursueTarget,
    ScanPlace,
    StopArm,
    TakePicture,
)
from pack_core.palletizing.ports import (
    SpawnBox as SpawnCommand,
)
from pack_core.ros.contracts import motion
from pack_core.ros.contracts import palletizing as contracts
from pack_core.ros.contracts.contract import Contract
from pack_core.ros.messages.conversions import from_stamp, to_pose
from pack_core.ros.messages.motion import to_target
from pack_core.ros.messages.palletizing import to_expected_box
from pack_core.ros.node import CellNode


class CellClient:
    """Sends commands and hears their answers.

    Args:
        node: that sends.
        on_spawned: is told the name of a box that has come.
        on_laid: is told the name of what the operator has laid on table A.
        on_failure: is told why a command was not done.
    """

    def __init__(
        self, node: CellNode, on_spawned: Callable[[str], None], on_laid: Callable[[str], None],
        on_failure: Callable[[str], None],
    ) -> None:  # fmt: skip
        self._node, self._on_failure = node, on_failure
        self._on_spawned, self._on_laid = on_spawned, on_laid
        self._target = node.advertise(motion.MOTION_TARGET)
        self._expected = node.advertise(contracts.EXPECTED_BOX)
        self._spawn, self._lay, self._remove, self._gripper, self._trigger = (
            self._client(contract)
            for contract in (
                contracts.SPAWN_BOX, contracts.LAY_ON_TABLE, contracts.REMOVE_BOX, contracts.GRIPPER_COMMAND,
                contracts.TRIGGER,
            )
        )  # fmt: skip
        self._scans = {
            PALLET: self._client(contracts.SCAN_PALLET),
            REORIENTATION_TABLE: self._client(contracts.SCAN_TABLE),
        }

    def apply(self, command: Command) -> None:
        """Send a command.

        A motion target without segments is a stop. A picture or a scan that is not taken is missed by the
        machine.
        """
        match command:
            case PursueTarget(target):
                self._target.publish(to_target(target, self._now()))
            case StopArm():
                self._target.publish(MotionTarget())
            case TakePicture(expected):
                self._expected.publish(to_expected_box(expected))
                self._trigger.call_async(Trigger.Request())
            case ScanPlace(place):
                self._scans[place].call_async(Trigger.Request())
            case SpawnCommand(name, dims, mass):
                self._on_spawned("")  # an earlier box may have had this name
                request = SpawnBox.Request(name=name, size=list(dims), mass=mass)
                self._call(self._spawn, request, f"box {name} cannot come", lambda: self._on_spawned(name))
            case LayOnTable(body, X_NB):
                self._on_laid("")  # as an earlier goal may have had the same laid
                lay = LayOnTableSrv.Request(name=body.name, size=list(body.size), mass=body.mass)
                lay.pose = to_pose(X_NB)
                self._call(self._lay, lay, f"{body.name} is not on table A", lambda: self._on_laid(body.name))
            case DiscardBox(name):
                # Somebody may have taken it already: it is out of the way either way.
                warn = self._node.get_logger().warning
                what = f"box {name} was not taken out"
                self._call(self._remove, RemoveBox.Request(name=name), what, on_failure=warn)
            case CloseGripper() | OpenGripper():
                close = isinstance(command, CloseGripper)
                self._call(
                    self._gripper, GripperCommand.Request(close=close), "the gripper refused the command"
                )

    def _now(self) -> float:
        return from_stamp(self._node.get_clock().now().to_msg())

    def _client(self, contract: Contract) -> Client:
        return self._node.create_client(contract.type, contract.name)

    def _call(
        self, client: Client, request: Any, what: str, on_success: Callable[[], None] = lambda: None,
        on_failure: Callable[[str], object] | None = None,
    ) -> None:  # fmt: skip
        def answered(future: Future) -> None:
            response = future.result()
            if response.success:
                on_success()
            else:
                (on_failure or self._on_failure)(f"{what}: {response.message}")

        client.call_async(request).add_done_callback(answered)
