"""Brings boxes to table A and has the camera find them, ahead of time where the profile says so."""

from __future__ import annotations

from pydantic import NonNegativeFloat, PositiveFloat

from pack_core.config import Config
from pack_core.palletizing.box_detection import BoxDetection, DetectionStatus, ExpectedBox
from pallet_fsm.ports import Command, PalletObservation, SpawnBox, TakePicture
from pallet_fsm.work_item import WorkItem


class FeederConfig(Config):
    """Times."""

    settle: NonNegativeFloat = 0.3
    """From a box's arrival to the picture, so that it rests [s]."""
    patience: PositiveFloat = 5.0
    """For a box to come, and for the camera's answer [s]."""


class Feeder:
    """One box at a time: sent for, arrived, looked at, found or not.

    Attributes:
        item: the box that is fed; None before the first.
        answer: of the camera, about this box since it was last looked at.
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
        """Have a box brought; does nothing when it is on its way."""
        if self.item is item:
            return
        self._sent = time
        self.item, self.answer, self._arrival, self._looked = item, None, None, None
        self._commands.append(SpawnBox(item.name, item.box.dims, item.box.weight))

    def forget(self) -> None:
        """Look again before believing anything."""
        self.answer = self._looked = None
        if self.item is not None:
            self.item.X_WB = None

    def look(self, time: float) -> None:
        """Have the box found; does nothing when that is under way or done, or before it rests."""
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
        """Take note of arrivals and answers."""
        if self.item is not None:
            if self._arrival is None and seen.spawned == self.item.name:
                self._arrival = seen.time
            self._note_answer(seen.detection)

    def commands(self) -> tuple[Command, ...]:
        """What is to be done since the last call."""
        commands, self._commands = tuple(self._commands), []
        return commands

    def _note_answer(self, detection: BoxDetection | None) -> None:
        if detection is None or self._looked is None or self.answer is not None or self.item is None:
            return
        if detection.box_id == self.item.name and detection.time >= self._looked:
            self.answer = detection
            if detection.status is DetectionStatus.DETECTED:
                self.item.X_WB = detection.X_WB
