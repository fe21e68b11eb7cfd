"""The machine's ports in the running cell: observations from topics, commands to topics and services."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from functools import partial
from typing import Any

from pack_interfaces.msg import MotionTarget, PalletPlaces
from pack_interfaces.srv import GripperCommand, PlanPlace, RemoveBox, ReplacePallet
from pack_interfaces.srv import LayOnTable as LayOnTableSrv
from pack_interfaces.srv import SpawnBox as SpawnBoxSrv
from rclpy.client import Client
from rclpy.task import Future
from std_srvs.srv import Trigger

from pack_core.errors import MessageError
from pack_core.joints import JointSample
from pack_core.motion import topics as motion_topics
from pack_core.palletizing.cell import PalletizingCell
from pack_core.palletizing.grip import GripState
from pack_core.palletizing.infeed import PlacesAway
from pack_core.palletizing.orders.next_place import PlaceAnswer, PlaceQuestion
from pack_core.palletizing.ports import (
    AskPlace,
    CloseGripper,
    Command,
    DiscardBox,
    LayOnTable,
    OpenGripper,
    PalletObservation,
    PursueTarget,
    ScanPlace,
    SendBox,
    SpawnBox,
    StopArm,
    TakePallet,
    TakePicture,
)
from pack_core.robots.kr210 import JOINTS
from pack_core.ros.contracts import motion
from pack_core.ros.contracts import palletizing as contracts
from pack_core.ros.contracts.contract import Contract
from pack_core.ros.messages.conversions import from_stamp, to_pose
from pack_core.ros.messages.motion import to_target
from pack_core.ros.messages.palletizing import (
    from_answer,
    from_cloud,
    from_detection,
    from_gripper_state,
    from_infeed,
    from_places,
    to_expected_box,
    to_question,
)
from pack_core.ros.messages.serialized import JointStateReader
from pack_core.ros.messages.serialized_status import MotionStatusReader
from pack_core.ros.newest_messages import Kept, NewestMessages
from pack_core.ros.node import CellNode

SAMPLES = round(motion_topics.JOINT_RATE)
"""Measurements of the joints that may wait: those of 1 s, as each counts for the weight in the hand."""


class CellPorts:
    """Hears of the cell, and sends it commands.

    Args:
        node: that listens and sends.
        on_motion: called in a thread of its own after every status of the motion.
        on_failure: is told why a command was not done.
        cell: the cell's physical facts.
    """

    def __init__(
        self, node: CellNode, on_motion: Callable[[], None], on_failure: Callable[[str], None],
        cell: PalletizingCell,
    ) -> None:  # fmt: skip
        self._node, self._on_failure = node, on_failure
        self._spawned = self._laid = ""
        self._place: PlaceAnswer | None = None
        self._question: PlaceQuestion | None = None
        self._sent_away = set[str]()
        """Places whose full pallet was sent away, until the cell says that none stands there."""
        self._target = node.advertise(motion.MOTION_TARGET)
        self._expected = node.advertise(contracts.EXPECTED_BOX)
        self._spawn, self._lay, self._remove, self._gripper, self._trigger = (
            self._client(contract)
            for contract in (
                contracts.SPAWN_BOX, contracts.LAY_ON_TABLE, contracts.REMOVE_BOX, contracts.GRIPPER_COMMAND,
                contracts.TRIGGER,
            )
        )  # fmt: skip
        self._send, self._replace, self.plan_place = (
            self._client(contract)
            for contract in (contracts.SEND_BOX, contracts.REPLACE_PALLET, contracts.PLAN_PLACE)
        )
        self._scans = {place: self._client(contracts.SCANS[place][0]) for place in cell.scanned}
        self._reader = JointStateReader(JOINTS)
        # bounded, as nobody fetches them while there is no goal
        self._samples: deque[JointSample] = deque(maxlen=SAMPLES)
        self._heard = NewestMessages(
            node,
            (
                Kept(contracts.BOX_DETECTION, from_detection),
                *(Kept(contracts.SCANS[place][1], partial(from_cloud, place=place)) for place in self._scans),
                Kept(contracts.INFEED_STATE, from_infeed),
                Kept(contracts.PALLET_PLACES, self._to_places),
                Kept(contracts.GRIPPER_STATE, from_gripper_state, depth=1),
                Kept(contracts.JOINT_STATES, self._to_sample, raw=True),
                Kept(motion.MOTION_STATUS, MotionStatusReader().read, depth=1, raw=True),
            ),
        )
        self._heard.follow(on_motion)

    def end(self) -> None:
        """Listen no more."""
        self._heard.end()

    @property
    def is_heard(self) -> bool:
        """Whether the first messages of motion and gripper have come."""
        return self._heard[motion.MOTION_STATUS] is not None and self.grip is not None

    @property
    def grip(self) -> GripState | None:
        """What the gripper last told; None before the first message."""
        return self._heard[contracts.GRIPPER_STATE]

    def observe(self) -> PalletObservation | None:
        """What is known now, with what was measured since the last call; None before `is_heard`.

        Its time is the node's clock; the motion's status has the time of the measurement, which is earlier.
        """
        status, grip = self._heard[motion.MOTION_STATUS], self.grip
        if status is None or grip is None:
            return None
        now = self._now()
        detection = self._heard.until(contracts.BOX_DETECTION, now)
        scans = (self._heard.until(contracts.SCANS[place][1], now) for place in self._scans)
        return PalletObservation(
            now, status, grip, self._spawned, detection, tuple(scan for scan in scans if scan is not None),
            self._laid, self._new_samples(), self._heard[contracts.INFEED_STATE], self._place, self._away(),
        )  # fmt: skip

    def _to_sample(self, data: bytes) -> JointSample:
        sample = self._reader.read(data)
        self._samples.append(sample)
        return sample

    def _new_samples(self) -> tuple[JointSample, ...]:
        """What was measured of the joints since the last call."""
        return tuple(self._samples.popleft() for _ in range(len(self._samples)))

    def _to_places(self, message: PalletPlaces) -> PlacesAway:
        told = from_places(message)
        self._sent_away -= told.places
        return told

    def _away(self) -> frozenset[str]:
        """The places on which no pallet stands: those that were told, and those just sent away."""
        told = self._heard[contracts.PALLET_PLACES] or PlacesAway(0.0)
        return told.places | self._sent_away

    def begin_shift(self) -> None:
        """Forget what an earlier shift asked for and has not heard of."""
        self._question = self._place = None
        self._sent_away.clear()

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
            case SendBox() | TakePallet() | AskPlace():
                self._apply_of_shift(command)
            case CloseGripper() | OpenGripper():
                close = isinstance(command, CloseGripper)
                self._call(
                    self._gripper, GripperCommand.Request(close=close), "the gripper refused the command"
                )

    def _apply_of_shift(self, command: SendBox | TakePallet | AskPlace) -> None:
        """Send a command that only a shift gives."""
        match command:
            case SendBox():
                # The shift does what it can without, and ends when no box has come for long.
                self._call(
                    self._send, Trigger.Request(), "the conveyor does not bring the next box",
                    on_failure=self._node.get_logger().error,
                )  # fmt: skip
            case TakePallet(place, boxes):
                self._sent_away.add(place)
                replace = ReplacePallet.Request(place=place, boxes=list(boxes))
                what = f"the full {place.replace('_', ' ')} is not taken away"
                self._call(self._replace, replace, what, on_failure=partial(self._note_kept, place))
            case AskPlace(question):
                self._question, self._place = question, None
                self._call(
                    self.plan_place, to_question(question), "nobody says where the next box goes",
                    partial(self._note_place, question), on_failure=partial(self._note_unanswered, question),
                )  # fmt: skip

    def _note_spawned(self, name: str, _: Any) -> None:
        self._spawned = name

    def _note_laid(self, name: str, _: Any) -> None:
        self._laid = name

    def _note_kept(self, place: str, reason: str) -> None:
        self._sent_away.discard(place)
        self._on_failure(reason)

    def _note_place(self, question: PlaceQuestion, response: PlanPlace.Response) -> None:
        if question is self._question:  # else it is late, and another shift has had the same number since
            self._place = from_answer(response, question.number)

    def _note_unanswered(self, question: PlaceQuestion, reason: str) -> None:
        if question is self._question:
            self._on_failure(reason)

    def _now(self) -> float:
        return from_stamp(self._node.get_clock().now().to_msg())

    def _client(self, contract: Contract) -> Client:
        return self._node.create_client(contract.type, contract.name)

    def _call(
        self, client: Client, request: Any, what: str, on_success: Callable[[Any], None] = lambda _: None,
        on_failure: Callable[[str], object] | None = None,
    ) -> None:  # fmt: skip
        def answered(future: Future) -> None:
            response = future.result()
            message = response.message
            if response.success:
                try:
                    on_success(response)
                    return
                except MessageError as error:
                    message = str(error)
            (on_failure or self._on_failure)(f"{what}: {message}")

        client.call_async(request).add_done_callback(answered)
