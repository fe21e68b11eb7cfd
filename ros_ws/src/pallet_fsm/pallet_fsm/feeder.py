"""Sends for boxes and has them detected on table A, ahead of time where the profile allows it."""

from __future__ import annotations

from pydantic import Field, NonNegativeFloat, PositiveFloat

from pack_core.config import Config
from pack_core.palletizing.boxes import BoxDetection, DetectionStatus, ExpectedBox
from pack_core.palletizing.ports import Command, PalletObservation, SpawnBox, TakePicture
from pallet_fsm.work_item import WorkItem


class FeederConfig(Config):
    """Times that the feeder waits."""

    settle: NonNegativeFloat = Field(
        default=0.3, description="time from a box's arrival to the picture, so that the box is at rest [s]"
    )
    patience: PositiveFloat = Field(
        default=5.0, description="longest time until a box arrives, and until the camera answers [s]"
    )


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
        self.item, self.answer, self._arrival, self._looked = item, None, None, None
        self._commands.append(SpawnBox(item.name, item.box.dims, item.box.weight))

    def forget(self) -> None:
        """Drop the detection of the box, so that it is detected again."""
        self.answer = self._looked = None
        if self.item is not None:
            self.item.X_WB = None

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
