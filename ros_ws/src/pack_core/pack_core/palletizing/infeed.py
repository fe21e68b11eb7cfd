"""What conveyor and pallet places of a shift tell."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class InfeedState:
    """What the conveyor of a shift tells.

    Attributes:
        time: present time [s].
        number: how many boxes have come to its barrier so far.
        box: the box that stands there, by what it is tracked by; empty while none does.
        label: what that box's bar code says; empty where it cannot be read.
    """

    time: float
    number: int = 0
    box: str = ""
    label: str = ""


@dataclass(frozen=True)
class PlacesAway:
    """The places on which no pallet stands.

    Attributes:
        time: when that was told [s].
        places: their names.
    """

    time: float
    places: frozenset[str] = frozenset()
