"""How many actions a state still needs, compiled: a lower bound, and guesses beyond it.

The guesses are of blocks that stand on each other's goals in circles, of pushes into the grid that few wait
for, and of interlocked blocks: those of which none can be carried away before a push has made room.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from numba import njit

from pack_planner.rearrangement.assembly import NEVER, pushes
from pack_planner.rearrangement.beam.spots import GOAL
from pack_planner.rearrangement.beam.states import Bits, bit, clear, count_bits, has, occupy
from pack_planner.rearrangement.beam.tables import MEMO_BITS, Tables
from pack_planner.rearrangement.footprints import Words, is_free

Spots = npt.NDArray[np.int16]
Flags = npt.NDArray[np.bool_]
CYCLE = 0.7
"""Actions that a block which must make way is taken to cost: less than one, as it may have to move anyway."""
CROWDED = 0.1
"""Actions that a goal which others leave without a grasp is taken to cost; it decides between equals."""
NOWHERE = -1
"""Instead of the number of a spot: the block has none."""
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


@njit(cache=True)
def standing_on_goals(spots: npt.NDArray[np.int16], crowds: Bits) -> Bits:
    """For every goal the other blocks that stand on it, as bits `(n,)`."""
    n = spots.shape[0]
    on_goal = np.zeros(n, dtype=np.uint64)
    for i in range(n):
        for j in range(n):
            if i != j and spots[i] != GOAL + i and (crowds[spots[i], 0] >> np.uint64(j)) & np.uint64(1):
                on_goal[j] |= bit(i)
    return on_goal


@njit(cache=True)
def cycles(on_goal: Bits, left: np.uint64) -> int:
    """About how many of the blocks `left` must make way, since they stand on each other's goals in circles.

    The greedy solution of the feedback vertex set problem: what stands on no other's goal, or on whose goal
    nothing stands, is in no circle; of the rest, the one on whose goal most others stand makes way.
    """
    n = on_goal.shape[0]
    count = 0
    while True:
        before = np.uint64(0)
        while left != before:
            before, standing = left, np.uint64(0)
            for j in range(n):
                if left & bit(j):
                    if on_goal[j] & left:
                        standing |= on_goal[j]
                    else:
                        left &= ~bit(j)
            left &= standing
        if not left:
            return count
        left &= ~bit(_most_occupied(on_goal, left))
        count += 1


@njit(cache=True)
def _most_occupied(on_goal: Bits, left: np.uint64) -> int:
    most, chosen = 0, 0
    for j in range(on_goal.shape[0]):
        if left & bit(j):
            total = count_bits(on_goal[j] & left)
            if total > most:
                most, chosen = total, j
    return chosen


@njit(cache=True, inline="always")
def likely_pushes(
    filled: np.uint64, ready: np.uint64, place_at: Bits, push_at: Bits, memo: Bits, memo_keys: Bits
) -> int:
    """`count_likely_pushes`, remembered: the states of a search have few sets of goals among them.

    Args:
        filled: goals that are filled, as bits.
        ready: blocks that stand on their push lines, as bits.
        place_at: sets of goals one of which must be unfilled to put a block down on its own `(n, ways)`.
        push_at: sets one of which must be unfilled to push it in `(n, ways)`.
        memo: results by a hash of both sets.
        memo_keys: which sets they are of, the inverse of filled + 2^32 ready.
    """
    key = ~(filled | (ready << np.uint64(32)))
    # Fibonacci hashing: 2^64 divided by the golden ratio spreads the key over the upper bits.
    slot = (key * np.uint64(0x9E3779B97F4A7C15)) >> np.uint64(64 - MEMO_BITS)
    if memo_keys[slot] != key:
        memo[slot] = count_likely_pushes(filled, ready, place_at, push_at)
        memo_keys[slot] = key
    return int(memo[slot])


@njit(cache=True)
def count_likely_pushes(filled: np.uint64, ready: np.uint64, place_at: Bits, push_at: Bits) -> int:
    """About how many blocks that are not `ready` on their push line will have to be pushed.

    The grid is taken apart from the full one, backwards, first what can be lifted or is ready, and if there
    is nothing, by a push of what most others wait for; NEVER where nothing can be pushed either.
    """
    n = place_at.shape[0]
    standing = (np.uint64(1) << np.uint64(n)) - np.uint64(1)
    count = 0
    while True:
        before = np.uint64(0)
        while standing != before:
            before = standing
            for j in range(n):
                if standing & ~filled & bit(j):
                    others = standing & ~bit(j)
                    if _has_room(place_at, j, others) or (ready & bit(j) and _has_room(push_at, j, others)):
                        standing = others
        if standing == filled:
            return count
        pushed = _most_awaited(standing, filled, place_at, push_at)
        if pushed < 0:
            return NEVER
        standing &= ~bit(pushed)
        count += 1


@njit(cache=True, inline="always")
def _has_room(sets: Bits, j: int, others: np.uint64) -> bool:
    """One of the sets of a row holds none of the others."""
    found = False
    for way in range(sets.shape[1]):
        found |= sets[j, way] & others == 0
    return found


@njit(cache=True)
def _most_awaited(standing: np.uint64, filled: np.uint64, place_at: Bits, push_at: Bits) -> int:
    """Of the blocks that can be pushed, that after which most others can be lifted; -1 for none."""
    n = place_at.shape[0]
    most, chosen = -1, -1
    for j in range(n):
        others = standing & ~bit(j)
        if standing & ~filled & bit(j) and _has_room(push_at, j, others):
            lifted = 0
            for i in range(n):
                if others & ~filled & bit(i) and _has_room(place_at, i, others & ~bit(i)):
                    lifted += 1
            if lifted > most:
                most, chosen = lifted, j
    return chosen


@njit(cache=True, inline="always")
def pushes_out_left(
    i: int, end: int, left: np.uint64, occupied: Words, spots: Spots, can_pick: Flags, tables: Tables
) -> int:
    """About how many pushes part interlocked blocks once block i has gone to a spot; NEVER if none would.

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
