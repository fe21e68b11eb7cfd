"""Blocks that cannot be carried away before a push has made room, compiled."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from numba import njit

from pack_planner.rearrangement.assembly import NEVER
from pack_planner.rearrangement.beam.bits import bit
from pack_planner.rearrangement.beam.spots import GOAL
from pack_planner.rearrangement.beam.states import clear, has, occupy
from pack_planner.rearrangement.beam.tables import Tables
from pack_planner.rearrangement.collisions import Words, is_free

Spots = npt.NDArray[np.int16]
Flags = npt.NDArray[np.bool_]


@njit(cache=True, inline="always")
def pushes_out_left(
    i: int, end: int, left: np.uint64, occupied: Words, spots: Spots, can_pick: Flags, tables: Tables
) -> int:
    """About how many pushes out are needed once block i has gone to a spot; NEVER if none would help.

    One after the other, whatever can be grasped or pushed home is taken away, and where nothing can, a block
    is pushed out of its start; what is home stays. Taking a block away only makes room: that it is none,
    some, or NEVER is proven, how many is a guess. What can be grasped at once goes first; often that is all.

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
    staying = left & ~held
    if end == GOAL + i:
        staying &= ~bit(i)
    return _undone(staying, i, end, left, occupied, spots, tables) if staying else 0


@njit(cache=True)
def _undone(
    staying: np.uint64, i: int, end: int, left: np.uint64, occupied: Words, spots: Spots, tables: Tables
) -> int:
    """The pushes out of a set of blocks, the others `left` gone; arguments as above."""
    obstacles, spots = occupied.copy(), spots.copy()
    for j in range(spots.shape[0]):
        if left & bit(j):
            clear(obstacles, spots[j])
    spots[i] = end
    if end == GOAL + i:
        occupy(obstacles, end)
    for j in range(spots.shape[0]):
        if staying & bit(j):
            occupy(obstacles, spots[j])
    count = 0
    while True:
        staying = _carried_away(staying, spots, obstacles, tables)
        if not staying:
            return count
        pushed = _pushed_out(staying, spots, obstacles, tables)
        if pushed == staying:
            return NEVER
        staying = pushed
        count += 1


@njit(cache=True)
def _carried_away(staying: np.uint64, spots: Spots, obstacles: Words, tables: Tables) -> np.uint64:
    """Take from the obstacles what can be carried, one after the other; the blocks that stay."""
    before = ~staying
    while staying != before:
        before = staying
        for j in range(spots.shape[0]):
            if staying & bit(j) and _can_be_carried(j, spots[j], obstacles, tables):
                staying &= ~bit(j)
                clear(obstacles, spots[j])
    return staying


@njit(cache=True)
def _pushed_out(staying: np.uint64, spots: Spots, obstacles: Words, tables: Tables) -> np.uint64:
    """Take from the obstacles the first that can be pushed out of its start; the blocks that stay."""
    for j in range(spots.shape[0]):
        if staying & bit(j) and spots[j] == j and _can_be_pushed_out(j, obstacles, tables):
            clear(obstacles, j)
            return staying & ~bit(j)
    return staying


@njit(cache=True, inline="always")
def _can_be_carried(j: int, spot: int, obstacles: Words, tables: Tables) -> bool:
    """Block j, one of the obstacles, can be grasped at its spot, or be pushed home from there."""
    clear(obstacles, spot)
    push = tables.push_of[j, spot]
    can = push >= 0 and is_free(tables.push[push], obstacles)
    for k in range(2):
        can |= is_free(tables.pick[spot, k], obstacles)
    occupy(obstacles, spot)
    return bool(can)


@njit(cache=True)
def _can_be_pushed_out(j: int, obstacles: Words, tables: Tables) -> bool:
    """Block j, one of the obstacles, can be pushed out of its start."""
    clear(obstacles, j)
    can = False
    for row in range(tables.out_first[j], tables.out_first[j + 1]):
        can |= is_free(tables.out[row], obstacles)
    occupy(obstacles, j)
    return can
