"""The state machine: it follows the table of transitions and keeps every state that it has entered."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from pack_core.errors import PackError
from pallet_fsm.states import ENDS, FAULTS, State
from pallet_fsm.transitions import RESUME, TRANSITIONS, Event, Guard, Transition


@dataclass(frozen=True)
class Visit:
    """A state that was entered.

    Attributes:
        state: which.
        time: when [s].
        box: name of the box in work.
        place: name of the pallet or table that the box goes to.
        event: what led here; None for the first state.
        reason: why, if it is a fault.
    """

    state: State
    time: float
    box: str = ""
    place: str = ""
    event: Event | None = None
    reason: str = ""


class Machine:
    """The present state, and all states before it.

    Args:
        time: now [s].
        holds: tells whether a guard holds.
        box: name of the first box in work.
        place: name of the pallet or table that it goes to.
    """

    def __init__(self, time: float, holds: Callable[[Guard], bool], box: str = "", place: str = "") -> None:
        self._holds = holds
        self._interrupted = State.SPAWN
        self.visits = [Visit(State.SPAWN, time, box, place)]

    @property
    def state(self) -> State:
        """The present state."""
        return self.visits[-1].state

    @property
    def since(self) -> float:
        """When the state was entered [s]."""
        return self.visits[-1].time

    @property
    def reason(self) -> str:
        """Reason of the last fault; empty if there was none."""
        return next((visit.reason for visit in reversed(self.visits) if visit.reason), "")

    @property
    def is_over(self) -> bool:
        """Whether the order has ended, one way or the other."""
        return self.state in ENDS

    def stop_after(self, state: State, stops_at: Callable[[State], bool]) -> State:
        """The first state from this one on at whose target the arm stops, if all targets are reached."""
        while not stops_at(state):
            state = self._following(self._row(state, Event.REACHED))
        return state

    def fire(self, event: Event, time: float, box: str = "", place: str = "", *, reason: str = "") -> State:
        """Enter the state that an event leads to; `box`, which goes to `place`, is in work from then on.

        Raises:
            PackError: the table has no row for this event here.
        """
        following = self._following(self._row(self.state, event))
        if following in FAULTS:
            self._interrupted = self.state
        self.visits.append(Visit(following, time, box, place, event, reason))
        return following

    def _following(self, row: Transition) -> State:
        return self._interrupted if row.next is RESUME else row.next

    def _row(self, state: State, event: Event) -> Transition:
        rows = [row for row in TRANSITIONS if row.state is state and row.event is event]
        for row in rows:
            if row.guard is None or self._holds(row.guard):
                return row
        allowed = sorted({row.event.value for row in TRANSITIONS if row.state is state})
        raise PackError(
            f"state '{state.label}' knows no event '{event.value}' now; "
            f"it knows: {', '.join(allowed) or 'none'}; change pallet_fsm/transitions.py"
        )
