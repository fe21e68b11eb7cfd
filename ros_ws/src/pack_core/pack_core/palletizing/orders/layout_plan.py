"""The answer of the layout service: where every box goes, in which sequence, and from which side it comes."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from pack_core.palletizing.orders.placed_box import PlacedBox
from pack_core.rotations import Array


class LayoutStatus(IntEnum):
    """Outcome; the values of pack_interfaces/PlanLayout."""

    SUCCESS = 1
    INFEASIBLE = 2
    UNSTABLE = 3
    INVALID_INPUT = 4


@dataclass(frozen=True)
class Insertion:
    """From where a box comes to its place (Sec. 6.3 of the thesis).

    Attributes:
        direction: name of the side it comes from; Center: straight down.
        outward: horizontal unit vector `(3,)` in P from the place towards where the box comes from; zero
            for Center.
        corridor: length [m] along `outward` that is free for the box at its height; zero for Center.
    """

    direction: str
    outward: Array
    corridor: float

    def start(self, centre: Array) -> Array:
        """Where the corridor begins `(3,)`: c + L d, Eq. 6.6, for the placed box's centre c."""
        return centre + self.corridor * self.outward

    def offset(self, standoff: float, lift: float) -> Array:
        """From the place to a point above and beside it `(3,)` [m], out by at most the corridor."""
        return np.asarray(min(standoff, self.corridor) * self.outward + np.array([0.0, 0.0, lift]))


@dataclass(frozen=True)
class PlannedBox:
    """A box in its regularised place, and how it comes there."""

    placed: PlacedBox
    insertion: Insertion


@dataclass(frozen=True)
class LayoutPlan:
    """A layout that can be built.

    Attributes:
        status: whether it was found.
        reason: why it was not, in words; empty after success.
        boxes: in the sequence in which they are to be placed; empty without success.
        gap: free distance between neighbours that was asked for [m].
        virtual_margin: how far boxes may stand over the pallet's edge to get it [m].
    """

    status: LayoutStatus
    reason: str
    boxes: tuple[PlannedBox, ...]
    gap: float
    virtual_margin: float
