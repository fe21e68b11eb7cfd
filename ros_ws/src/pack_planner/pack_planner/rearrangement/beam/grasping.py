"""How a block can be carried, compiled."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from numba import njit

from pack_planner.rearrangement.beam.spots import GOAL
from pack_planner.rearrangement.beam.states import NO_STAGE, PUSHED
from pack_planner.rearrangement.beam.tables import Tables
from pack_planner.rearrangement.collisions import Words, is_free

Flags = npt.NDArray[np.bool_]


@njit(cache=True, inline="always")
def swaps(i: int, start: int, end: int, tables: Tables) -> int:
    """1 where a grasp along one axis of the one spot is a grasp along the other axis of the other, else 0.

    Where a block may be turned by quarters, what takes the smaller turn.
    """
    if tables.is_symmetric:
        turn = (tables.poses[end, 2] - tables.poses[start, 2] + np.pi / 2) % np.pi - np.pi / 2
        return 1 if abs(turn) > np.pi / 4 else 0
    return 1 if tables.swap[i, start] != tables.swap[i, end] else 0


@njit(cache=True, inline="always")
def way_home(i: int, spot: int, can_pick: Flags, occupied: Words, tables: Tables) -> tuple[int, int]:
    """Staging pose and pair of grasps of block i's shortest way to its goal; the pair is -1 for none."""
    swap = swaps(i, spot, GOAL + i, tables)
    pair = _pair(can_pick[i], tables.place[GOAL + i], swap, occupied, tables.is_symmetric)
    if pair >= 0:
        return NO_STAGE, pair
    push = tables.push_of[i, spot]
    if push >= 0 and is_free(tables.push[push], occupied):
        return NO_STAGE, PUSHED
    if can_pick[i, 0] or can_pick[i, 1]:
        for m in range(tables.stage.shape[1]):
            if is_free(tables.stage_push[i, m], occupied):
                pair = _pair(can_pick[i], tables.stage_place[i, m], swap, occupied, tables.is_symmetric)
                if pair >= 0:
                    return m, pair
    return NO_STAGE, -1


@njit(cache=True, inline="always")
def _pair(can_pick: Flags, place: Words, swap: int, occupied: Words, is_symmetric: bool) -> int:
    """2 * axis at the pick + axis at the place, without an extra turn by a quarter if possible; or -1."""
    for turned in range(1 + is_symmetric):
        for k in range(2):
            # The axis at the place: the one at the pick, exchanged where the spots' axes are, and once more
            # where a symmetric block is turned by a quarter.
            end = k ^ swap ^ turned
            if can_pick[k] and is_free(place[end], occupied):
                return 2 * k + end
    return -1
