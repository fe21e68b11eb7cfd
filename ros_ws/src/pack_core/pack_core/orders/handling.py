"""How a box gets from the way it arrives to the way it stands on the pallet.

Chapter 5 of the thesis names an orientation by `orient_id` and `bundling_axis`. Its bypass rules leave one
consistent reading: the planner's triple (l, w, h) is (d_x, d_y, d_z) with bundling axis z and (d_x, d_z, d_y)
with y, and `orient_id` is a fixed permutation of it. Ids 1 and 3, which the thesis prints twice or upside
down, are given the two orientations that would be missing.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import Literal

import numpy as np

from pack_core.rotations import Array, conjugate, from_rpy, multiply

OrientId = Literal[0, 1, 2, 3, 4, 5]
BundlingAxis = Literal["z", "y"]
Extents = tuple[float, float, float]

PERMUTATIONS: dict[OrientId, tuple[int, int, int]] = {
    0: (0, 1, 2),
    1: (1, 2, 0),
    2: (2, 0, 1),
    3: (2, 1, 0),
    4: (1, 0, 2),
    5: (0, 2, 1),
}
"""Which of l, w and h lie along the pallet's x, y and z."""

ARRIVAL: dict[BundlingAxis, tuple[int, int, int]] = {"z": (0, 1, 2), "y": (0, 2, 1)}
"""Which of d_x, d_y and d_z are l, w and h."""

DOWN = (0.0, np.pi / 2, 0.0)
SIDEWAYS = (np.pi / 2, np.pi / 2, 0.0)
TOOL_RPY: dict[tuple[int, int, int], tuple[float, float, float]] = {
    (0, 1, 2): DOWN,
    (1, 0, 2): SIDEWAYS,
    (0, 2, 1): (np.pi / 2, 0.0, np.pi / 2),
    (1, 2, 0): (0.0, 0.0, np.pi / 2),
    (2, 0, 1): (np.pi / 2, 0.0, 0.0),
    (2, 1, 0): (0.0, 0.0, 0.0),
}
"""Roll, pitch and yaw of the thesis's tool frame (x: approach) that bring d_i along x, y and z."""

THESIS_TOOL = from_rpy((0.0, -np.pi / 2, 0.0))
"""The thesis's tool frame in the cell's (z: approach)."""


class Handling(StrEnum):
    """What has to be done to a box on its way."""

    NONE = "none"
    FLIP = "flip"
    TABLE = "table"


@dataclass(frozen=True)
class Turn:
    """From the way a box arrives, d_x along the world's x and d_z up, to the way it stands on the pallet.

    Attributes:
        handling: what it takes: nothing, a quarter turn in flight, or standing it up on the table.
        extents: of the box on the pallet along x, y and z [m].
        q_reorient: orientation of the tool, quaternion wxyz, once it has turned the box it took from above.
        q_place: orientation of the tool when it puts the box on the pallet.
    """

    handling: Handling
    extents: Extents
    q_reorient: Array
    q_place: Array

    @property
    def q_box(self) -> Array:
        """The box's rotation, quaternion wxyz."""
        return multiply(self.q_reorient, conjugate(tool_orientation(DOWN)))


def turn_of(dims: Extents, axis: BundlingAxis, orient_id: OrientId) -> Turn:
    """The turn a box needs; where sides are equal, the cheapest that gives the same extents."""
    arrival = ARRIVAL[axis]
    i, j, k = (arrival[n] for n in PERMUTATIONS[orient_id])
    extents = dims[i], dims[j], dims[k]
    cheapest = next(order for order in (*TOOL_RPY, (i, j, k)) if tuple(dims[n] for n in order) == extents)
    handling = {(0, 1, 2): Handling.NONE, (1, 0, 2): Handling.FLIP}.get(cheapest, Handling.TABLE)
    rpy = TOOL_RPY[cheapest]
    place = DOWN if handling is Handling.TABLE else rpy
    return Turn(handling, extents, tool_orientation(rpy), tool_orientation(place))


def tool_orientation(rpy: tuple[float, float, float]) -> Array:
    """The cell's tool frame, quaternion wxyz, where the thesis's has this roll, pitch and yaw [rad]."""
    return multiply(from_rpy(rpy), conjugate(THESIS_TOOL))
