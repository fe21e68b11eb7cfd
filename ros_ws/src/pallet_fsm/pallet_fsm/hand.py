"""Closes and opens the gripper, and waits for the vacuum."""

from __future__ import annotations

from pack_core.palletizing.grip import ASKED, GripState
from pallet_fsm.ports import CloseGripper, Command, OpenGripper
from pallet_fsm.states import Grip
from pallet_fsm.transitions import Event


class Hand:
    """One closing or opening at a time.

    Args:
        dwell: for the vacuum to build up or break down [s].
        timeout: for the gripper to do as it is told [s].

    Attributes:
        is_busy: whether it closes or opens just now.
        reason: why the last closing failed.
    """

    def __init__(self, dwell: float, timeout: float) -> None:
        self._dwell, self._timeout = dwell, timeout
        self._grip = Grip.EMPTY
        self._start = 0.0
        self.is_busy = False
        self.reason = ""

    def begin(self, grip: Grip, time: float) -> Command:
        """Close or open; to be followed by `look` until an event comes of it."""
        self._grip, self._start, self.is_busy, self.reason = grip, time, True, ""
        return CloseGripper() if grip is Grip.CLOSE else OpenGripper()

    def look(self, state: GripState, time: float) -> Event | None:
        """What has come of it, if anything yet.

        That it was asked to open is why the gripper was open before: no answer to a closing.
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
