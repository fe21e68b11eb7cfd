"""Where a calibration or its check stands, for the operator who follows it."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum


class CalibrationState(Enum):
    """What is being done; the values are shown."""

    TOUCH = "touch surfaces"
    TAKE_BOARD = "take the board"
    SHOW_BOARD = "show the board"
    RETURN_BOARD = "put the board back"
    TOUCH_DECK = "touch the deck"
    TAKE_BOX = "see the test box"
    MOVE_BOX = "move the test box"
    FIT = "fit"
    DONE = "done"


USUAL = {
    CalibrationState.TOUCH: 8.5,
    CalibrationState.TAKE_BOARD: 7.0,
    CalibrationState.SHOW_BOARD: 4.0,
    CalibrationState.RETURN_BOARD: 6.0,
    CalibrationState.TOUCH_DECK: 12.0,
    CalibrationState.TAKE_BOX: 2.0,
    CalibrationState.MOVE_BOX: 14.0,
}
"""What one unit of each state usually takes [s]; the first estimate of what is left."""


@dataclass(frozen=True)
class CalibrationProgress:
    """Where the work stands.

    Attributes:
        state: what is being done.
        what: on what, in words; may be empty.
        number: of the present unit of this state, from 1.
        count: how many units this state has.
        remaining: estimated time to the end of what the arm does [s].
    """

    state: CalibrationState
    what: str
    number: int
    count: int
    remaining: float

    @property
    def words(self) -> str:
        """The same in a line."""
        of = f" {self.number} of {self.count}" if self.count > 1 else ""
        what = f": {self.what}" if self.what else ""
        return f"{self.state.value}{of}{what}; about {self.remaining:.0f} s left"


class Agenda:
    """What is to be done, and how long that will take.

    Args:
        counts: how many units each state has, in their sequence.
    """

    def __init__(self, counts: dict[CalibrationState, int]) -> None:
        self._counts = counts
        self._usual = dict(USUAL)
        self._state: CalibrationState | None = None
        self._what, self._number, self._since = "", 0, 0.0

    def begin(self, state: CalibrationState, what: str, time: float) -> None:
        """A unit of a state begins at `time` [s]; the one before is over."""
        if self._state is not None:
            # The mean of what was expected and of what it took: one unit that was far away says little.
            self._usual[self._state] += 0.5 * (time - self._since - self._usual[self._state])
        self._number = self._number + 1 if state is self._state else 1
        self._state, self._what, self._since = state, what, time

    def progress(self, time: float) -> CalibrationProgress:
        """Where the work stands at `time` [s]; the first unit counts as begun."""
        states = list(self._counts)
        state = self._state or states[0]
        rest = max(self._usual[state] - (time - self._since if self._state else 0.0), 0.0)
        rest += (self._counts[state] - max(self._number, 1)) * self._usual[state]
        for later in states[states.index(state) + 1 :]:
            rest += self._counts[later] * self._usual[later]
        return CalibrationProgress(state, self._what, max(self._number, 1), self._counts[state], rest)
