"""The profiles: the arm stops and is checked at every state, or passes the transit states without a stop."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from pack_core.errors import ConfigError
from pallet_fsm.states import MOVING, ROWS, Part, State


@dataclass(frozen=True)
class Profile:
    """One way to run the steps.

    Attributes:
        parts: part of a blended move that each state is; empty: every state is a move of its own with a stop.
        feeds_ahead: whether the next box is sent for and detected while this one is still in work; if not,
            that is done in states 0 and 1.
    """

    parts: Mapping[State, Part]
    feeds_ahead: bool

    @property
    def is_blended(self) -> bool:
        """Whether a move runs through several states."""
        return bool(self.parts)

    def stops_at(self, state: State) -> bool:
        """Whether the arm comes to rest at the state's target."""
        return self.parts.get(state, Part.FINAL) is Part.FINAL


PROFILES = {
    "thesis": Profile({}, feeds_ahead=False),
    "blended": Profile({state: ROWS[state].part for state in MOVING}, feeds_ahead=True),
}


def profile_of(name: str) -> Profile:
    """The profile called `name`; raises ConfigError where there is none."""
    if name not in PROFILES:
        raise ConfigError(f"profile '{name}'; allowed: {', '.join(PROFILES)}")
    return PROFILES[name]
