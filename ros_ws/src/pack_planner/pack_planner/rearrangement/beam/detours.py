"""Guesses of what a state needs beyond the lower bound, compiled: blocks in circles, pushes in the end."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from numba import njit

from pack_planner.rearrangement.assembly import NEVER
from pack_planner.rearrangement.beam.bits import MEMO_BITS, Bits, bit, count_bits
from pack_planner.rearrangement.beam.spots import GOAL


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
