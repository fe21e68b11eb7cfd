"""Assembly pattern database: how many pushes it takes at least to fill the rest of the goals.

A goal can be filled by picking and placing as long as one grasp's fingers find room among the goals filled
before it; else by a push, as long as one way in is free; else never (`GoalAccess`). `pushes(filled)` is the
least number of pushes over all orders in which the rest may be filled, by dynamic programming over all sets
of goals.

The sets are bits of words: word `w` of a plane holds the 64 sets whose upper goals are `w`, so that one
operation serves 64 sets. Plane `k` has the sets that at most `k` pushes complete, the last plane those that
any number does. 2^25 sets take about a third of a second, 2^16 half a millisecond.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numba import njit

from pack_core.blocks.gripper import GripperFootprint
from pack_core.blocks.planar import QUARTER
from pack_core.rotations import Array
from pack_planner.rearrangement.footprints import Words, hits, outlines, placings, sweeps

LOW = 6
"""Goals that are told apart within a word: a word of 64 bits has one for every set of 6 goals."""
PLANES = 14
"""Numbers of pushes that are told apart, 0 to 12, and one plane for any number."""
MAX_GOALS = 25
"""Of one database; 2^25 sets in 14 planes are 59 MB."""
NEVER = 99
"""Pushes to complete a set that cannot be completed."""
FULL = np.uint64(0xFFFFFFFFFFFFFFFF)
"""The set of everything: all bits of a word."""


@dataclass(frozen=True)
class BlockingSets:
    """For every goal: alternative sets of goals, of which one must be wholly unfilled still, as bits."""

    alternatives: tuple[tuple[int, ...], ...]

    @classmethod
    def of(cls, alternatives: Iterable[Iterable[int]]) -> BlockingSets:
        """Without the alternatives that demand more than another one does."""
        return cls(tuple(_minimal(sets) for sets in alternatives))

    def rows(self) -> Words:
        """As an array `(goals, alternatives)`, filled up with sets of everything."""
        width = max((len(sets) for sets in self.alternatives), default=0) or 1
        rows = np.full((len(self.alternatives), width), FULL, dtype=np.uint64)
        for goal, sets in enumerate(self.alternatives):
            rows[goal, : len(sets)] = sets
        return rows

    def within(self, first: int, count: int) -> BlockingSets:
        """The same among `count` goals from `first` on, as if the others were never filled."""
        kept = (1 << count) - 1
        rows = self.alternatives[first : first + count]
        return BlockingSets.of([[(s >> first) & kept for s in sets] for sets in rows])


def _minimal(sets: Iterable[int]) -> tuple[int, ...]:
    distinct = sorted(set(sets))
    return tuple(s for s in distinct if not any(t != s and t & s == t for t in distinct))


@lru_cache(maxsize=8)
def assembly_planes(place: BlockingSets, push: BlockingSets) -> Words:
    """The database `(words, PLANES)` of up to MAX_GOALS goals."""
    n = len(place.alternatives)
    planes = np.zeros((1 << max(n - LOW, 0), PLANES), dtype=np.uint64)
    _fill(planes, n, place.rows(), push.rows(), _low_words())
    planes.setflags(write=False)
    return planes


def _low_words() -> Words:
    """For every set of lower goals the word of the lower sets that have none of them `(64,)`."""
    return np.array([sum(1 << low for low in range(64) if not low & s) for s in range(64)], dtype=np.uint64)


@njit(cache=True)
def _fill(planes: Words, n: int, place_rows: Words, push_rows: Words, low_words: Words) -> None:
    words, last = planes.shape[0], planes.shape[1] - 1
    place, push = np.zeros(n, dtype=np.uint64), np.zeros(n, dtype=np.uint64)
    for w in range(words - 1, -1, -1):
        for goal in range(n):
            place[goal] = _possible(np.uint64(w), place_rows[goal], low_words)
            push[goal] = _possible(np.uint64(w), push_rows[goal], low_words)
        complete = np.uint64(0)
        if w == words - 1:
            complete = np.uint64(1) << np.uint64((1 << min(n, LOW)) - 1)
        planes[w, last] = _grow(planes, n, w, last, last, complete, place, push, low_words)
        planes[w, 0] = _grow(planes, n, w, 0, -1, complete, place, push, low_words)
        for k in range(1, last):
            planes[w, k] = planes[w, k - 1]
            if planes[w, k] != planes[w, last]:
                planes[w, k] = _grow(planes, n, w, k, k - 1, planes[w, k], place, push, low_words)


@njit(cache=True, inline="always")
def _grow(
    planes: Words, n: int, w: int, k: int, source: int, value: np.uint64, place: Words, push: Words,
    low_words: Words,
) -> np.uint64:  # fmt: skip
    """Plane `k` of word `w`: with one goal filled more, the set is in plane `k`, or by a push in `source`."""
    for goal in range(LOW, n):
        bit = 1 << (goal - LOW)
        if not w & bit:
            value |= place[goal] & planes[w | bit, k]
            if source >= 0:
                value |= push[goal] & planes[w | bit, source]
    before = ~value
    while value != before:
        before = value
        for goal in range(min(n, LOW)):
            shift, without = np.uint64(1 << goal), low_words[1 << goal]
            value |= place[goal] & (value >> shift) & without
            if source == k:
                value |= push[goal] & (value >> shift) & without
            elif source >= 0:
                value |= push[goal] & (planes[w, source] >> shift) & without
    return value


@njit(cache=True, inline="always")
def _possible(w: np.uint64, alternatives: Words, low_words: Words) -> np.uint64:
    """The lower sets that leave one of the alternatives free, with the upper goals `w` filled."""
    value = np.uint64(0)
    for i in range(alternatives.shape[0]):
        if not (alternatives[i] >> np.uint64(LOW)) & w:
            value |= low_words[alternatives[i] & np.uint64(63)]
    return value


@njit(cache=True)
def pushes(planes: Words, filled: np.uint64) -> int:
    """Least number of pushes to fill the rest; PLANES - 1 stands for that many or more, or NEVER."""
    row, bit = planes[filled >> np.uint64(LOW)], filled & np.uint64(63)
    for k in range(planes.shape[1]):
        if (row[k] >> bit) & np.uint64(1):
            return k
    return NEVER


@dataclass(frozen=True)
class GoalAccess:
    """For every goal the sets of goals of which one must be unfilled, to put a block down or to push it in.

    Of pushes only the end counts, so that no push, however short, is left out.
    """

    place: BlockingSets
    push: BlockingSets

    @classmethod
    def of(cls, goals: Array, shapes: Array, gripper: GripperFootprint) -> GoalAccess:
        """Find what bars the access to goals at poses `(n, 3)` for blocks of shapes `(n, 3)`."""
        headings = goals[:, 2, None] + QUARTER * np.arange(4)
        ends = np.repeat(goals[:, None], 4, axis=1)
        pushes = sweeps(ends, headings, 0.0, shapes[:, None], gripper)[..., None, :]
        blocks = outlines(goals, shapes)
        return cls(
            BlockingSets.of(sets_of_others(hits(placings(goals, shapes, gripper), blocks))),
            BlockingSets.of(sets_of_others(hits(pushes, blocks))),
        )


def sets_of_others(words: Words) -> list[list[int]]:
    """For every block the sets of others that its footprints `(n, ways, W)` hit, as bits."""
    values = [[sum(int(word) << 64 * w for w, word in enumerate(row)) for row in rows] for rows in words]
    return [[value & ~(1 << i) for value in row] for i, row in enumerate(values)]
