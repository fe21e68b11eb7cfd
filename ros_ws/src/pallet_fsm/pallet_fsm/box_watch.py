"""What the machine waits for at table A: that a box comes, that it is found, and that it stays there."""

from __future__ import annotations

from pack_core.palletizing.boxes import DetectionStatus
from pack_core.palletizing.cell import PalletizingCell
from pack_core.palletizing.ports import Command, PalletObservation
from pallet_fsm.feeder import Feeder
from pallet_fsm.palletizer_config import PalletizerConfig
from pallet_fsm.second_look import SecondLook
from pallet_fsm.states import State
from pallet_fsm.transitions import Event
from pallet_fsm.work_item import WorkItem

Happening = tuple[Event, str]
"""An event, and its reason in words; empty where it needs none."""


class BoxWatch:
    """Sends for boxes, has pictures taken, and tells what they show.

    Args:
        config: parameters of the machine.
        cell: the cell's physical facts.
    """

    def __init__(self, config: PalletizerConfig, cell: PalletizingCell) -> None:
        self._tries = config.tries
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
        self._feeder.send_for(item, time)
        if self._feeder.has_arrived:
            return Event.SPAWNED, ""
        return (Event.HALTED, f"box {item.name} does not come") if self._feeder.is_late(time) else None

    def sighting(self, item: WorkItem, time: float) -> Happening | None:
        """Have the box looked at, and tell what was seen."""
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

    def forget(self) -> None:
        """Drop what is known of the box's place, so that it is looked for again."""
        self._feeder.forget()

    def feed_ahead(self, item: WorkItem, time: float) -> None:
        """Send for the next box and have it looked at while another one is on its way."""
        self._feeder.send_for(item, time)
        self._feeder.look(time)

    def _silence(self, item: WorkItem) -> Happening:
        """The camera's: no box can be found without it, so the last try ends the order."""
        is_last = item.tries[State.NO_DETECTION] + 1 >= self._tries
        return Event.HALTED if is_last else Event.NO_DETECTION, "the camera does not answer"
