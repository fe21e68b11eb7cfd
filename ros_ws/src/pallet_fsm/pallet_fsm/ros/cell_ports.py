"""The machine's ports in the running cell: observations from topics, commands to topics and services."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from pack_interfaces.msg import MotionTarget
from pack_interfaces.srv import GripperCommand, RemoveBox
from pack_interfaces.srv import LayOnTable as LayOnTableSrv
from pack_interfaces.srv import SpawnBox as SpawnBoxSrv
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
    PalletObservation,
    PursueTarget,
    ScanPlace,
    SpawnBox,
    StopArm,
    TakePicture,
)
from pack_core.ros.contracts import motion
from pack_core.ros.contracts import palletizing as contracts
from pack_core.ros.contracts.contract import Contract
from pack_core.ros.messages.conversions import from_stamp, to_pose
from pack_core.ros.messages.motion import to_target
from pack_core.ros.messages.palletizing import (
    from_cloud,
    from_detection,
    from_gripper_state,
    to_expected_box,
)
from pack_core.ros.messages.serialized_status import MotionStatusReader
from pack_core.ros.newest_messages import Kept, NewestMessages
from pack_core.ros.node import CellNode


class CellPorts:
    """Hears of the cell, and sends it commands.

    Args:
        node: that listens and sends.
        on_motion: called in a thread of its own after every status of the motion.
        on_failure: is told why a command was not done.
    """

    def __init__(
        self, node: CellNode, on_motion: Callable[[], None], on_failure: Callable[[str], None]
    ) -> None:
        self._node, self._on_failure = node, on_failure
        self._spawned = self._laid = ""
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
        self._heard = NewestMessages(
            node,
            (
                Kept(contracts.BOX_DETECTION, from_detection),
                Kept(contracts.PALLET_SCAN, partial(from_cloud, place=PALLET)),
                Kept(contracts.TABLE_SCAN, partial(from_cloud, place=REORIENTATION_TABLE)),
                Kept(contracts.GRIPPER_STATE, from_gripper_state, depth=1),
                Kept(motion.MOTION_STATUS, MotionStatusReader().read, depth=1, raw=True),
            ),
        )
        self._heard.follow(on_motion)

    def end(self) -> None:
        """Listen no more."""
        self._heard.end()

    def observe(self) -> PalletObservation | None:
        """What is known now; None before the first messages of motion and gripper.

        Its time is the node's clock; the motion's status has the time of the measurement, which is earlier.
        """
        status, grip = self._heard[motion.MOTION_STATUS], self._heard[contracts.GRIPPER_STATE]
        if status is None or grip is None:
            return None
        now = self._now()
        detection = self._heard.until(contracts.BOX_DETECTION, now)
        scans = (self._heard.until(topic, now) for topic in (contracts.PALLET_SCAN, contracts.TABLE_SCAN))
        return PalletObservation(
            now, status, grip, self._spawned, detection, tuple(scan for scan in scans if scan is not None),
            self._laid,
        )  # fmt: skip

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
            case SpawnBox(name, dims, mass):
                self._spawned = ""  # an earlier box may have had this name
                request = SpawnBoxSrv.Request(name=name, size=list(dims), mass=mass)
                self._call(self._spawn, request, f"box {name} cannot come", partial(self._note_spawned, name))
            case LayOnTable(body, X_NB):
                self._laid = ""  # an earlier goal may have had the same laid
                lay = LayOnTableSrv.Request(name=body.name, size=list(body.size), mass=body.mass)
                lay.pose = to_pose(X_NB)
                what = f"{body.name} is not on table A"
                self._call(self._lay, lay, what, partial(self._note_laid, body.name))
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

    def _note_spawned(self, name: str) -> None:
        self._spawned = name

    def _note_laid(self, name: str) -> None:
        self._laid = name

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
