"""What a running cell is at, and what can be asked of it now."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class CellCondition:
    """The cell as whoever operates it has to know it.

    Attributes:
        is_up: whether the simulator has been heard of.
        waits_for: why no goal can be taken now, in words; empty where one can.
        is_busy: whether a goal is in progress.
        is_starting: whether a start was pressed whose goal has not been taken yet.
        is_paused: whether simulated time stands still.
        is_stopped: whether the arm was stopped and follows no setpoints.
    """

    is_up: bool = False
    waits_for: str = ""
    is_busy: bool = False
    is_starting: bool = False
    is_paused: bool = False
    is_stopped: bool = False

    @property
    def can_start(self) -> bool:
        """A goal at a time, and none in a cell that stands still or is not up."""
        return self.is_up and not (self.waits_for or self.is_busy or self.is_starting or self.is_paused)

    @property
    def can_cancel(self) -> bool:
        """There must be something to cancel, and time for it to end."""
        return self.is_up and self.is_busy and not self.is_paused

    @property
    def can_pause(self) -> bool:
        """Any time, and so can going on."""
        return self.is_up

    @property
    def can_stop(self) -> bool:
        """Always but when the arm is stopped already."""
        return self.is_up and not self.is_stopped

    @property
    def can_resume(self) -> bool:
        """Only after a stop, and once the goal that it ended has ended."""
        return self.is_up and self.is_stopped and not self.is_busy

    @property
    def in_words(self) -> str:
        """What the cell is at, or waits for."""
        if not self.is_up:
            return "waiting for the simulator"
        if self.is_stopped:
            return "the arm is stopped; resume, or start anew"
        if self.is_paused:
            return "paused"
        if self.is_busy:
            return "a goal is in progress"
        return "starting" if self.is_starting else self.waits_for or "ready for a goal"
