"""Blocks that can never move again, compiled."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from numba import njit

from pack_planner.rearrangement.beam.bits import bit
from pack_planner.rearrangement.beam.spots import GOAL
from pack_planner.rearrangement.beam.states import clear, has, occupy
from pack_planner.rearrangement.beam.tables import Tables
from pack_planner.rearrangement.collisions import Words, is_free

Spots = npt.NDArray[np.int16]
Flags = npt.NDArray[np.bool_]


@njit(cache=True, inline="always")
def is_deadlocked(
    i: int, end: int, left: np.uint64, occupied: Words, spots: Spots, can_pick: Flags, tables: Tables
) -> bool:
    """Once block i has gone to a spot, some of the blocks `left` away from their goals can never move.

    One after the other, whatever can be grasped or pushed is taken away, as that only makes room; what is
    home stays. What can be grasped at once goes first; that is often all.

    Args:
        i: block that goes; where it is carried to, it can be grasped again.
        end: spot to which it goes.
        left: blocks away from their goals before it goes, as bits.
        occupied: spots before it goes; whether that of block i is among them does not matter.
        spots: of all blocks before it goes `(n,)`.
        can_pick: by which grasps blocks can be picked before it goes `(n, 2)`.
        tables: geometry.
    """
    held = np.uint64(0)
    for j in range(spots.shape[0]):
        for k in range(2):
            if can_pick[j, k] and (j == i or not has(tables.pick[spots[j], k], end)):
                held |= bit(j)
    stuck = left & ~held
    if end == GOAL + i:
        stuck &= ~bit(i)
    return bool(stuck != 0 and _are_stuck(stuck, i, end, left, occupied, spots, tables))


@njit(cache=True)
def _are_stuck(
    stuck: np.uint64, i: int, end: int, left: np.uint64, occupied: Words, spots: Spots, tables: Tables
) -> bool:
    """Some of a set of blocks can never move, whatever the others `left` do; arguments as above."""
    obstacles = occupied.copy()
    for j in range(spots.shape[0]):
        if left & bit(j):
            clear(obstacles, spots[j])
    if end == GOAL + i:
        occupy(obstacles, end)
    for j in range(spots.shape[0]):
        if stuck & bit(j):
            occupy(obstacles, end if j == i else spots[j])
    before = ~stuck
    while stuck != before:
        before = stuck
        for j in range(spots.shape[0]):
            if stuck & bit(j):
                spot = end if j == i else spots[j]
                clear(obstacles, spot)
                if _can_leave(j, spot, obstacles, tables):
                    stuck &= ~bit(j)
                else:
                    occupy(obstacles, spot)
    return bool(stuck != 0)


@njit(cache=True)
def _can_leave(j: int, spot: int, obstacles: Words, tables: Tables) -> bool:
    """Block j can be grasped at its spot, or pushed home or out of its start."""
    for k in range(2):
        if is_free(tables.pick[spot, k], obstacles):
            return True
    push = tables.push_of[j, spot]
    if push >= 0 and is_free(tables.push[push], obstacles):
        return True
    if spot == j:
        for row in range(tables.out_first[j], tables.out_first[j + 1]):
            if is_free(tables.out[row], obstacles):
                return True
    return False
