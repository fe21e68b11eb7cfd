"""What the machine waits for at table A: that a box comes, that it is found, and that it stays there.

A box is sent for and found ahead of time where the profile allows it. As that picture may be seconds old when
the arm arrives, the box is looked at a second time on the way, just before the arm comes between it and the
camera.
"""

from __future__ import annotations

import numpy as np

from pack_core.motion.world import CarriedBox
from pack_core.palletizing.boxes import BoxDetection, DetectionStatus, ExpectedBox
from pack_core.palletizing.cell import PICKING_TABLE, PalletizingCell
from pack_core.palletizing.ports import Command, PalletObservation, SpawnBox, TakePicture
from pack_core.rotations import Array, Pose, angle_between, from_yaw, multiply
from pallet_fsm.order_book import WorkItem
from pallet_fsm.palletizer_config import FeederConfig, PalletizerConfig, SecondLookConfig
from pallet_fsm.place_watch import ArmShadow
from pallet_fsm.states import State
from pallet_fsm.transitions import Event, Happening


class Feeder:
    """Feeds one box at a time: it sends for the box, waits for its arrival, and has it detected.

    Attributes:
        item: the box that is fed; None before the first.
        answer: detection from the last picture of this box; None until it comes.
    """

    def __init__(self, config: FeederConfig) -> None:
        self._config = config
        self.item: WorkItem | None = None
        self.answer: BoxDetection | None = None
        self._sent = 0.0
        self._arrival: float | None = None
        self._looked: float | None = None
        self._commands: list[Command] = []

    @property
    def has_arrived(self) -> bool:
        """Whether the box stands on table A."""
        return self._arrival is not None

    def send_for(self, item: WorkItem, time: float) -> None:
        """Send for a box; does nothing when that was done already."""
        if self.item is item:
            return
        self._sent = time
        self.item, self.answer, self._looked = item, None, None
        self._arrival = time - self._config.settle if item.has_come else None
        if not item.has_come:
            self._commands.append(SpawnBox(item.name, item.box.dims, item.box.weight))

    def forget(self, item: WorkItem) -> None:
        """Drop the detection of the box that is fed, so that it is detected again; of no other one."""
        if self.item is item:
            self.answer = self._looked = None
            item.X_WB = None

    def look(self, time: float) -> None:
        """Take a picture of the box; does nothing if one was taken already, or before the box is at rest."""
        if self.item is None or self._arrival is None or self._looked is not None:
            return
        if time >= self._arrival + self._config.settle:
            self._looked = time
            self._commands.append(TakePicture(ExpectedBox(self.item.name, self.item.box.dims, time)))

    def is_late(self, time: float) -> bool:
        """Whether the box has not come in time."""
        return self._arrival is None and time > self._sent + self._config.patience

    def is_overdue(self, time: float) -> bool:
        """Whether the camera has not answered in time."""
        waits = self.answer is None and self._looked is not None
        return waits and time > (self._looked or 0.0) + self._config.patience

    def observe(self, seen: PalletObservation) -> None:
        """Note the arrival of the box, and the detection that belongs to its picture."""
        if self.item is not None:
            if self._arrival is None and seen.spawned == self.item.name:
                self._arrival = seen.time
            self._note_answer(seen.detection)

    def commands(self) -> tuple[Command, ...]:
        """The commands since the last call."""
        commands, self._commands = tuple(self._commands), []
        return commands

    def _note_answer(self, detection: BoxDetection | None) -> None:
        if detection is None or self._looked is None or self.answer is not None or self.item is None:
            return
        if detection.box_id == self.item.name and detection.time >= self._looked:
            self.answer = detection
            if detection.status is DetectionStatus.DETECTED:
                self.item.X_WB = detection.X_WB


NEARLY_SQUARE = 0.004
"""Edges that differ by less do not tell in a picture which way round the box lies [m]."""


class SecondLook:
    """One look at one box at a time.

    Args:
        config: when it is taken, and what counts as a change.
        table: middle of table A `(3,)` [m].
    """

    def __init__(self, config: SecondLookConfig, table: Array) -> None:
        self._config, self._table = config, table
        self._item: WorkItem | None = None
        self._was_far = False
        self._asked: float | None = None
        self._answer: BoxDetection | None = None

    def begin(self, item: WorkItem | None) -> None:
        """Set off to a box that was just detected; None: to one that no picture is taken of."""
        self._item, self._was_far, self._asked, self._answer = item, False, None, None

    def follow(self, seen: PalletObservation) -> TakePicture | None:
        """Take note of what is known now; the picture, once it is time for it.

        An arm that sets off from near the table has just been looked past; there is no second picture then.
        """
        item, detection = self._item, seen.detection
        if item is None:
            return None
        if self._asked is None:
            is_far = np.linalg.norm((seen.motion.X_WT.p - self._table)[:2]) > self._config.distance
            if is_far or not self._was_far:
                self._was_far |= bool(is_far)
                return None
            self._asked = seen.time
            return TakePicture(ExpectedBox(item.name, item.box.dims, seen.time))
        if detection is not None and detection.box_id == item.name and detection.time >= self._asked:
            self._answer = detection
        return None

    @property
    def is_awaited(self) -> bool:
        """Whether the picture was taken and is not answered."""
        return self._asked is not None and self._answer is None

    def change(self, time: float) -> str:
        """What is not as it was when the box was detected, in words; empty where nothing is known of."""
        if self.is_awaited:
            is_late = time > (self._asked or 0.0) + self._config.patience
            return "the camera does not answer" if is_late else ""
        if self._item is None or self._answer is None:
            return ""
        if self._answer.status is not DetectionStatus.DETECTED or self._answer.X_WB is None:
            return f"on a second look: {self._answer.reason}"
        return self._difference(self._item, self._answer.X_WB)

    def _difference(self, item: WorkItem, X_WB: Pose) -> str:
        if item.X_WB is None:
            return ""
        shift = float(np.linalg.norm(X_WB.p - item.X_WB.p))
        turn = _turn_deg(item.X_WB.q, X_WB.q, item.dims)
        if shift <= self._config.position and turn <= self._config.angle_deg:
            return ""
        return f"on a second look the box is {1e3 * shift:.0f} mm and {turn:.1f} degrees from where it was"


def _turn_deg(first: Array, second: Array, dims: Array) -> float:
    """Between two orientations of a box on a table [deg]; turns after which it looks alike count as none."""
    quarters = (0, 1, 2, 3) if abs(dims[0] - dims[1]) < NEARLY_SQUARE else (0, 2)
    alike = (multiply(second, from_yaw(n * np.pi / 2)) for n in quarters)
    return float(np.rad2deg(min(angle_between(first, q) for q in alike)))


class BoxWatch:
    """Sends for boxes, has pictures taken, and tells what they show.

    Args:
        config: parameters of the machine.
        cell: the cell's physical facts.
    """

    def __init__(self, config: PalletizerConfig, cell: PalletizingCell) -> None:
        self._tries, self._clear = config.tries, config.feeder.clear
        table = next(block for block in cell.furniture if block.name == PICKING_TABLE)
        self._shadow = ArmShadow(table, cell)
        self._feeder = Feeder(config.feeder)
        self._second_look = SecondLook(config.second_look, cell.picking_table.middle)
        self._pictures: list[Command] = []

    @property
    def is_looking(self) -> bool:
        """Whether the second look at the box in work is not answered yet."""
        return self._second_look.is_awaited

    def observe(self, seen: PalletObservation) -> None:
        """Take note of boxes that have come, and of what is seen of them."""
        self._feeder.observe(seen)

    def commands(self) -> tuple[Command, ...]:
        """The commands since the last call."""
        pictures, self._pictures = tuple(self._pictures), []
        return (*pictures, *self._feeder.commands())

    def arrival(self, item: WorkItem, time: float) -> Happening | None:
        """Send for a box, and tell when it has come or is too late."""
        if self._is_known(item):
            return Event.SPAWNED, ""
        self._feeder.send_for(item, time)
        if self._feeder.has_arrived:
            return Event.SPAWNED, ""
        return (Event.HALTED, f"box {item.name} does not come") if self._feeder.is_late(time) else None

    def sighting(self, item: WorkItem, time: float) -> Happening | None:
        """Have the box looked at, and tell what was seen."""
        if self._is_known(item):
            self._second_look.begin(None)
            return Event.DETECTED, ""
        self._feeder.look(time)
        answer = self._feeder.answer
        if answer is None:
            return self._silence(item) if self._feeder.is_overdue(time) else None
        if answer.status is DetectionStatus.DETECTED:
            self._second_look.begin(item)
            return Event.DETECTED, ""
        is_wrong = answer.status is DetectionStatus.WRONG_SIZE
        return Event.WRONG_SIZE if is_wrong else Event.NO_DETECTION, answer.reason

    def change(self, seen: PalletObservation) -> Happening | None:
        """Have the box looked at once more on the way to it, and tell if it has changed."""
        picture = self._second_look.follow(seen)
        if picture is not None:
            self._pictures.append(picture)
        reason = self._second_look.change(seen.time)
        return (Event.BOX_CHANGED, reason) if reason else None

    def forget(self, item: WorkItem) -> None:
        """Drop where pictures showed a box, so that it is looked for again.

        One that was set aside, or scanned on the conveyor, is left where it is known to stand.
        """
        self._feeder.forget(item)

    def feed_ahead(self, item: WorkItem, seen: PalletObservation, carried: CarriedBox | None) -> None:
        """Send for the next box and have it looked at while another one is on its way.

        Args:
            item: the next box.
            seen: what is known now.
            carried: the box in the hand, if there is one.
        """
        if self._is_known(item):
            return
        if self._feeder.item is not item and self._shadow.clearance(seen.motion.X_WT, carried) < self._clear:
            return
        self._feeder.send_for(item, seen.time)
        self._feeder.look(seen.time)

    def is_about_to_find(self, item: WorkItem | None) -> bool:
        """Whether a box was sent for and the camera has not said yet where it is."""
        return item is not None and self._feeder.item is item and self._feeder.answer is None

    def _is_known(self, item: WorkItem) -> bool:
        """Whether a box that was never sent for stands in a known place: set aside, or scanned there."""
        return item.X_WB is not None and self._feeder.item is not item

    def _silence(self, item: WorkItem) -> Happening:
        """The camera's: no box can be found without it, so the last try ends the order."""
        is_last = item.tries[State.NO_DETECTION] + 1 >= self._tries
        return Event.HALTED if is_last else Event.NO_DETECTION, "the camera does not answer"
