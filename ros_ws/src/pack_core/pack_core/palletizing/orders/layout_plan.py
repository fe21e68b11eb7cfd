"""The answer of the layout service: where every box goes, in which sequence, and from which side it comes."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from pack_core.palletizing.orders.placed_box import PlacedBox
from pack_core.rotations import Array


class LayoutStatus(IntEnum):
    """Outcome of planning a layout; the values are those of pack_interfaces/PlanLayout."""

    SUCCESS = 1
    INFEASIBLE = 2
    UNSTABLE = 3
    INVALID_INPUT = 4


@dataclass(frozen=True)
class Insertion:
    """The way on which a box comes to its place (Sec. 6.3 of the thesis).

    Attributes:
        direction: name of the side that the box comes from; Center: straight down.
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
    """A box at its place in the layout with gaps, and its insertion."""

    placed: PlacedBox
    insertion: Insertion


@dataclass(frozen=True)
class LayoutPlan:
    """A layout that can be built.

    Attributes:
        status: whether a layout was found.
        reason: why none was found, in words; empty after success.
        boxes: the boxes in the sequence in which they are to be placed; empty without success.
        gap: the wanted free distance between neighbours [m].
        virtual_margin: how far boxes may stand over the pallet's edge to reach the gap [m].
    """

    status: LayoutStatus
    reason: str
    boxes: tuple[PlannedBox, ...]
    gap: float
    virtual_margin: float
