"""How many actions a state still needs, compiled: a lower bound, and guesses beyond it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from numba import njit

from pack_planner.rearrangement.assembly import NEVER, pushes
from pack_planner.rearrangement.beam.bits import Bits, bit, count_bits
from pack_planner.rearrangement.beam.detours import cycles, likely_pushes, standing_on_goals
from pack_planner.rearrangement.beam.spots import GOAL
from pack_planner.rearrangement.beam.tables import Tables
from pack_planner.rearrangement.collisions import Words

CYCLE = 0.7
"""Actions that a block which must make way is taken to cost."""
CROWDED = 0.1
"""Actions that a goal which other blocks leave without a grasp is taken to cost."""
NOWHERE = -1
ONE = np.uint64(1)


class StateSummary(NamedTuple):
    """What the estimates of all children of a state have in common.

    Attributes:
        filled: goals filled, as bits.
        left: blocks away from their goals, as bits.
        ready: blocks on their push lines, as bits.
        away: number of blocks left.
        pushes: that the rest of the grid needs at least.
        likely: pushes that it likely needs, of blocks that are not ready.
        bound: at least so many actions are left.
        on_goal: for every goal the other blocks that stand on it, as bits `(n,)`.
        crowded: for every block the goals that the other blocks leave without a grasp, as bits `(n,)`.
    """

    filled: np.uint64
    left: np.uint64
    ready: np.uint64
    away: int
    pushes: int
    likely: int
    bound: int
    on_goal: Bits
    crowded: Bits


@njit(cache=True, inline="always")
def summarize(occupied: Words, spots: npt.NDArray[np.int16], tables: Tables) -> StateSummary:
    """What the estimates of all children of a state have in common."""
    n = spots.shape[0]
    filled = occupied[0] >> np.uint64(GOAL)  # the first word has the starts, then from bit GOAL the goals
    left, ready = np.uint64(0), np.uint64(0)
    for i in range(n):
        if spots[i] != GOAL + i:
            left |= bit(i)
            if tables.push_of[i, spots[i]] >= 0:
                ready |= bit(i)
    crowded = np.zeros(n, dtype=np.uint64)
    for i in range(n):
        if left & bit(i):
            for j in range(n):
                if j != i:
                    crowded[j] |= tables.crowds[spots[i], 1] & left & ~bit(i)
    needed = pushes_left(filled, tables.planes, tables.upper_planes, tables.split)
    away = count_bits(left)
    return StateSummary(
        filled, left, ready, away, needed,
        _likely(filled, ready, tables),
        # One action a block, and one more for every push of a block that is not on its push line yet.
        away + max(needed - count_bits(ready), 0), standing_on_goals(spots, tables.crowds), crowded,
    )  # fmt: skip


@njit(cache=True, inline="always")
def after_going_home(i: int, now: StateSummary, circles: int, tables: Tables) -> tuple[int, float, int]:
    """Lower bound, likely detours and pushes left once block i is home; NEVER if that spoils the grid."""
    filled = now.filled | ONE << np.uint64(i)
    needed = pushes_left(filled, tables.planes, tables.upper_planes, tables.split)
    ready = now.ready & ~bit(i)
    likely = _likely(filled, ready, tables)
    if needed == NEVER or likely == NEVER:
        return NEVER, 0.0, 0
    bound = now.away - 1 + max(needed - count_bits(ready), 0)
    detours = now.away - 1 + likely - bound + CYCLE * circles
    return bound, detours + CROWDED * count_bits(now.crowded[i] & ~bit(i)), needed


@njit(cache=True, inline="always")
def after_making_way(i: int, end: int, now: StateSummary, circles: int, tables: Tables) -> tuple[int, float]:
    """Lower bound and likely detours once block i waits at a buffer pose."""
    ready, likely = now.ready & ~bit(i), now.likely
    if tables.push_of[i, end] >= 0:
        ready |= bit(i)
    if ready != now.ready:
        likely = _likely(now.filled, ready, tables)
    bound = now.away + max(now.pushes - count_bits(ready), 0)
    crowded = now.crowded[i] | (tables.crowds[end, 1] & now.left & ~bit(i))
    return bound, now.away + likely - bound + CYCLE * circles + CROWDED * count_bits(crowded)


@njit(cache=True, inline="always")
def cycles_with(i: int, spot: int, now: StateSummary, tables: Tables) -> int:
    """`cycles` once block i stands on a spot, or NOWHERE."""
    on_goal = now.on_goal.copy()
    for j in range(on_goal.shape[0]):
        on_goal[j] &= ~bit(i)
        if spot != NOWHERE and j != i and tables.crowds[spot, 0] & bit(j):
            on_goal[j] |= bit(i)
    return int(cycles(on_goal, now.left))


@njit(cache=True)
def pushes_left(filled: np.uint64, planes: Words, upper_planes: Words, split: int) -> int:
    """Pushes that the rest of the grid needs at least; NEVER if it is spoilt."""
    # Grids too large for one database are cut in two halves, each as if the other were never filled: fewer
    # goals in the way need no more pushes, so the sum is still a lower bound.
    lower = pushes(planes, filled & ((ONE << np.uint64(split)) - ONE))
    upper = pushes(upper_planes, filled >> np.uint64(split))
    return NEVER if lower == NEVER or upper == NEVER else lower + upper


@njit(cache=True, inline="always")
def _likely(filled: np.uint64, ready: np.uint64, tables: Tables) -> int:
    return likely_pushes(filled, ready, tables.place_at, tables.push_at, tables.memo, tables.memo_keys)
