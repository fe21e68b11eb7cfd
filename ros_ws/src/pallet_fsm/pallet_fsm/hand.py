"""Closes and opens the gripper, and waits for the vacuum to build up or break down."""

from __future__ import annotations

from pack_core.palletizing.grip import ASKED, GripState
from pack_core.palletizing.ports import CloseGripper, Command, OpenGripper
from pallet_fsm.states import Grip
from pallet_fsm.transitions import Event


class Hand:
    """Runs one closing or opening of the gripper at a time.

    Args:
        dwell: time for the vacuum to build up or break down [s].
        timeout: longest time until the gripper has carried out a command [s].

    Attributes:
        is_busy: whether a closing or opening is under way.
        reason: why the last one failed; empty if it did not.
    """

    def __init__(self, dwell: float, timeout: float) -> None:
        self._dwell, self._timeout = dwell, timeout
        self._grip = Grip.EMPTY
        self._start = 0.0
        self.is_busy = False
        self.reason = ""

    def begin(self, grip: Grip, time: float) -> Command:
        """Close or open the gripper; then `look` is to be called until it returns an event."""
        self._grip, self._start, self.is_busy, self.reason = grip, time, True, ""
        return CloseGripper() if grip is Grip.CLOSE else OpenGripper()

    def look(self, state: GripState, time: float) -> Event | None:
        """The event that ends the closing or opening; None while it is under way.

        A gripper that is open with the reason `ASKED` was opened before and has not answered a closing yet.
        """
        waited = time - self._start
        if waited < self._dwell:
            return None
        wanted = self._grip is Grip.CLOSE
        if state.is_closed is wanted:
            return self._end(Event.GRIPPED if wanted else Event.RELEASED)
        answer = "" if state.is_closing or state.reason == ASKED else state.reason
        if not (wanted and answer) and waited < self._timeout:
            return None
        self.reason = answer or f"the gripper does not {self._grip.value}"
        return self._end(Event.GRIP_FAILED if wanted else Event.HALTED)

    def _end(self, event: Event) -> Event:
        self.is_busy = False
        return event
