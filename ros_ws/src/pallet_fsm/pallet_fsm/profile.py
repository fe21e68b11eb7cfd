"""How the states become motion: stop and check at each, or pass the transit states without stopping."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import IntEnum

from pack_core.errors import ConfigError
from pallet_fsm.states import State


class Part(IntEnum):
    """The parts of a blended move from one stop of the arm to the next, in their order.

    A state whose part is NONE has no way-point of its own and is passed when it is entered.
    """

    NONE = -1
    DEPART = 0
    CROSS = 1
    APPROACH = 2
    FINAL = 3


@dataclass(frozen=True)
class Profile:
    """One way to run the 21 states.

    Attributes:
        parts: of a blended move, by state; empty: every state is a move of its own, with a stop.
        feed_at: state from which the next box is sent for and looked at while this one is still in work;
            None: states 0 and 1 do.
    """

    parts: Mapping[State, Part]
    feed_at: State | None = None

    @property
    def is_blended(self) -> bool:
        """Whether a move runs through several states."""
        return bool(self.parts)

    def stops_at(self, state: State) -> bool:
        """Whether the arm comes to rest at the state's target."""
        return self.parts.get(state, Part.FINAL) is Part.FINAL


# fmt: off
_BLENDED = {
    State.ABOVE_BOX: Part.CROSS, State.GRASP: Part.FINAL,
    State.LIFT: Part.DEPART, State.SAFE_PICK: Part.NONE, State.SAFE_TABLE: Part.NONE,
    State.ROTATE: Part.CROSS, State.RELEASE_TABLE: Part.FINAL,
    State.STEP_BACK: Part.DEPART, State.RISE: Part.NONE, State.ABOVE_TABLE: Part.CROSS,
    State.REGRASP: Part.FINAL,
    State.LIFT_TABLE: Part.DEPART, State.LEAVE_TABLE: Part.NONE, State.TRANSFER: Part.NONE,
    State.ABOVE_PALLET: Part.CROSS, State.PRE_DEPOSIT: Part.APPROACH, State.DEPOSIT: Part.FINAL,
    State.RETREAT: Part.DEPART, State.RETURN: Part.NONE,
}
# fmt: on

PROFILES = {
    "thesis": Profile({}),
    "blended": Profile(_BLENDED, feed_at=State.PRE_DEPOSIT),
}


def profile_of(name: str) -> Profile:
    """The profile called `name`; raises ConfigError where there is none."""
    if name not in PROFILES:
        raise ConfigError(f"profile '{name}'; allowed: {', '.join(PROFILES)}")
    return PROFILES[name]
