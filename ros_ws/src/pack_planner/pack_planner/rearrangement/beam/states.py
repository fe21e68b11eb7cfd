"""States of the search, what follows from them, and the moves that led to them, as arrays.

A set of blocks is a word of 64 bits. A state is a set of spots in words: spot q is bit q % 64 of word
q // 64.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from numba import njit

from pack_core.rotations import Array
from pack_planner.rearrangement.beam.spots import Ints
from pack_planner.rearrangement.beam.tables import Tables
from pack_planner.rearrangement.footprints import Words

NO_STAGE = -1
"""Instead of the number of a staging pose: the block is not staged."""
PUSHED = 4
"""Instead of a pair of grasps: the block was pushed."""
ONE = np.uint64(1)
Bits = npt.NDArray[np.uint64]


@njit(cache=True, inline="always")
def bit(i: int) -> np.uint64:
    """The set of block i."""
    return np.uint64(1) << np.uint64(i)


@njit(cache=True, inline="always")
def count_bits(bits: np.uint64) -> int:
    """Number of blocks in a set."""
    total = 0
    while bits:
        bits &= bits - np.uint64(1)  # takes the lowest block out of the set
        total += 1
    return total


class States(NamedTuple):
    """A layer of B states.

    Attributes:
        occupied: spots `(B, W)`.
        spot: of every block `(B, n)`.
        node: number in the search's history `(B,)`.
        travel: of the gripper so far [m] `(B,)`.
        premium: what the pushes so far cost beyond one action each, see PushPrice `(B,)`.
        tool: where the gripper is [m] `(B, 2)`.
        cycles: estimated number of blocks that must make way `(B,)`.
        hash: `(B,)`
    """

    occupied: Words
    spot: npt.NDArray[np.int16]
    node: Ints
    travel: Array
    premium: Array
    tool: Array
    cycles: Ints
    hash: Words


class Children(NamedTuple):
    """What follows from the states of a layer, C children.

    Attributes:
        moves: rows of integers `(C, 5)`: the parent's row in the layer; which block goes; to which spot; by
            which staging pose, or NO_STAGE; by which grasps, 2 * axis at the pick + axis at the place, or
            PUSHED.
        bound: at least so many actions are left `(C,)`.
        cycles: `(C,)`
        detours: actions that are likely left beyond the bound `(C,)`.
        travel: as in States `(C,)`.
        premium: as in States, this move's push among them `(C,)`.
        premium_left: what the pushes left cost at least beyond one action each `(C,)`.
        hash: as in States `(C,)`.
    """

    moves: Ints
    bound: Ints
    cycles: Ints
    detours: Array
    travel: Array
    premium: Array
    premium_left: Array
    hash: Words


@njit(cache=True)
def empty_children(room: int) -> Children:
    """Arrays for up to `room` children, not filled yet."""
    return Children(
        np.empty((room, 5), np.int32), np.empty(room, np.int32), np.empty(room, np.int32),
        np.empty(room, np.float64), np.empty(room, np.float64), np.empty(room, np.float64),
        np.empty(room, np.float64), np.empty(room, np.uint64),
    )  # fmt: skip


@njit(cache=True)
def first_children(children: Children, count: int) -> Children:
    """Copies of the first `count` children."""
    return Children(
        children.moves[:count].copy(), children.bound[:count].copy(), children.cycles[:count].copy(),
        children.detours[:count].copy(), children.travel[:count].copy(), children.premium[:count].copy(),
        children.premium_left[:count].copy(), children.hash[:count].copy(),
    )  # fmt: skip


@njit(cache=True)
def follow(
    states: States, children: Children, kept: npt.NDArray[np.int64], nodes: Ints, poses: Array
) -> States:
    """The states of the children that are kept, numbered `nodes`."""
    rows = children.moves[kept, 0]
    occupied, spots, tool = states.occupied[rows], states.spot[rows], states.tool[rows]
    for row in range(kept.shape[0]):
        _, i, spot, _, _ = children.moves[kept[row]]
        clear(occupied[row], spots[row, i])
        occupy(occupied[row], spot)
        spots[row, i] = spot
        tool[row] = poses[spot, :2]
    return States(
        occupied, spots, nodes, children.travel[kept], children.premium[kept], tool, children.cycles[kept],
        children.hash[kept],
    )  # fmt: skip


@njit(cache=True, inline="always")
def clear(occupied: Words, spot: int) -> None:
    """Take the block away from a spot."""
    occupied[spot // 64] &= ~(ONE << np.uint64(spot % 64))


@njit(cache=True, inline="always")
def occupy(occupied: Words, spot: int) -> None:
    """Put a block on a spot."""
    occupied[spot // 64] |= ONE << np.uint64(spot % 64)


@njit(cache=True, inline="always")
def has(words: Words, spot: int) -> bool:
    """The spot is in the set."""
    return bool((words[spot // 64] >> np.uint64(spot % 64)) & ONE)


@njit(cache=True, inline="always")
def append(
    out: Children,
    count: int,
    states: States,
    tables: Tables,
    row: int,
    i: int,
    end: int,
    stage: int,
    pair: int,
) -> None:
    """Let child `count` be block i's way to a spot, by a staging pose or not; estimates are left open."""
    start = states.spot[row, i]
    move = out.moves[count]
    move[0], move[1], move[2], move[3], move[4] = row, i, end, stage, pair
    # Zobrist hashing: a state's hash is the exclusive or of a random number for each block at its spot, so a
    # move takes one number out and puts one in, and the same state has the same hash by whatever way.
    out.hash[count] = states.hash[row] ^ tables.hash[i, start] ^ tables.hash[i, end]
    ax, ay = tables.poses[start, 0], tables.poses[start, 1]
    bx, by = tables.poses[end, 0], tables.poses[end, 1]
    length = states.travel[row] + np.hypot(ax - states.tool[row, 0], ay - states.tool[row, 1])
    if stage != NO_STAGE:
        cx, cy = tables.stage[i, stage, 0], tables.stage[i, stage, 1]
        length += np.hypot(cx - ax, cy - ay)
        ax, ay = cx, cy
    # What is left of the way is the push, if there is one: from its start or its staging pose to the end.
    last = np.hypot(bx - ax, by - ay)
    out.travel[count] = length + last
    out.premium[count] = states.premium[row]
    if stage != NO_STAGE or pair == PUSHED:
        out.premium[count] += tables.push_price.extra + tables.push_price.per_metre * last


@njit(cache=True, inline="always")
def estimate(out: Children, count: int, bound: int, cycles: int, detours: float, premium_left: float) -> None:
    """Note the estimates of child `count`."""
    out.bound[count], out.cycles[count], out.detours[count] = bound, cycles, detours
    out.premium_left[count] = premium_left


@dataclass(frozen=True)
class BlockMove:
    """A block goes to a spot; stage and grasps as in Children."""

    block: int
    spot: int
    stage: int
    grasps: int


@dataclass
class History:
    """A tree of moves; its nodes are numbered in the order in which they were added, the root is 0."""

    _chunks: list[Ints] = field(default_factory=lambda: [np.full((1, 5), -1, dtype=np.int32)])
    size: int = 1

    def add(self, parents: Ints, children: Children, kept: npt.NDArray[np.int64]) -> Ints:
        """Record children `kept` of layers whose nodes are `parents`; their numbers."""
        chunk = children.moves[kept]
        chunk[:, 0] = parents[chunk[:, 0]]
        self._chunks.append(chunk)
        numbers = np.arange(self.size, self.size + len(kept), dtype=np.int32)
        self.size += len(kept)
        return numbers

    def moves(self, node: int) -> list[BlockMove]:
        """The moves that lead from the root to a node."""
        rows = np.concatenate(self._chunks)
        path = []
        while node > 0:
            parent, *move = rows[node].tolist()
            path.append(BlockMove(*move))
            node = parent
        return path[::-1]
