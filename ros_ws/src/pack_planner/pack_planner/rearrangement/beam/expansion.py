"""One step of the beam search, compiled: all children of all states of a layer.

A block that can go home goes home: by picking and placing, by a push if it stands on its push line, or by
being put there and pushed. A block that cannot, or that stands in another's way, goes to a buffer pose; one
that cannot even be grasped at its start is pushed out.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from numba import njit

from pack_planner.rearrangement.assembly import NEVER
from pack_planner.rearrangement.beam.estimates import (
    NOWHERE,
    StateSummary,
    after_going_home,
    after_making_way,
    cycles_with,
    pushes_out_left,
    summarize,
)  # fmt: skip
from pack_planner.rearrangement.beam.moves import (
    Options,
    buffer_options,
    note_obstacles,
    note_obstacles_of_pushes,
    pushed_out_options,
    way_home,
)
from pack_planner.rearrangement.beam.spots import GOAL, POOL, Ints
from pack_planner.rearrangement.beam.states import (
    NO_STAGE,
    Children,
    States,
    append,
    bit,
    clear,
    empty_children,
    estimate,
    first_children,
    has,
    occupy,
)  # fmt: skip
from pack_planner.rearrangement.beam.tables import Tables
from pack_planner.rearrangement.footprints import Words, is_free

Flags = npt.NDArray[np.bool_]


# The functions below are inlined into `expand` and take what they read one by one: a tuple around it would be
# built anew for every state, in the innermost loop. The arguments come in this order throughout: the layer
# (states, row), the block (i), its state (occupied, now, can_pick), what is filled (must_go, blocking or
# options, found), then tables, limit, and the children with their number (out, count).


@njit(cache=True)
def expand(
    states: States, tables: Tables, order: Ints, breadth: int, limit: int, is_anyone: bool
) -> Children:
    """All children of a layer.

    Args:
        states: the layer.
        tables: geometry.
        order: buffer poses in the order in which every block looks at them `(n, P)`.
        breadth: buffer poses that are tried for a block.
        limit: children with more actions left than this are dropped.
        is_anyone: blocks may go to buffer poses though they are in nobody's way.
    """
    rows, n = states.spot.shape
    # A block has at most `breadth` buffer poses, or as many ends of pushes out of its start as there are.
    room = max(breadth, tables.out_spot.shape[0])
    options = Options(np.empty(room, np.int32), np.empty(room, np.int32), np.empty(breadth))
    # Of every state: each block home (1) or to buffer poses (breadth), and every push out of a start.
    out = empty_children(rows * (n * (1 + breadth) + tables.out_spot.shape[0]))
    can_pick, must_go = np.empty((n, 2), np.bool_), np.empty(n, np.bool_)
    count = 0
    for row in range(rows):
        occupied, spots = states.occupied[row].copy(), states.spot[row]
        now = summarize(occupied, spots, tables)
        _note_grasps(occupied, spots, tables, can_pick)
        blocking = np.zeros_like(occupied)
        count = _go_home(states, row, occupied, now, can_pick, must_go, blocking, tables, limit, out, count)
        # Making way brings no block home, so it leaves as many actions as before and takes one besides.
        if now.bound > limit:
            continue
        for i in range(n):
            spot = spots[i]
            if spot == GOAL + i or not (must_go[i] or has(blocking, spot) or is_anyone):
                continue
            found = 0
            if can_pick[i, 0] or can_pick[i, 1]:
                found = buffer_options(i, spots, can_pick, now, now.bound == limit, order, tables, options)
            elif spot == i:  # the block stands on its start, which has the number of the block
                clear(occupied, spot)
                found = pushed_out_options(i, occupied, tables, options)
                occupy(occupied, spot)
            count = _make_way(
                states, row, i, occupied, now, can_pick, options, found, tables, limit, out, count
            )
    return first_children(out, count)


@njit(cache=True, inline="always")
def _note_grasps(occupied: Words, spots: npt.NDArray[np.int16], tables: Tables, can_pick: Flags) -> None:
    """By which grasps the blocks that are not home can be picked."""
    for i in range(spots.shape[0]):
        spot = spots[i]
        if spot != GOAL + i:
            clear(occupied, spot)
            for k in range(2):
                can_pick[i, k] = is_free(tables.pick[spot, k], occupied)
            occupy(occupied, spot)


@njit(cache=True, inline="always")
def _go_home(
    states: States, row: int, occupied: Words, now: StateSummary, can_pick: Flags, must_go: Flags,
    blocking: Words, tables: Tables, limit: int, out: Children, count: int,
) -> int:  # fmt: skip
    """Append children in which a block goes home; the new number of children.

    Notes which blocks must leave their starts without going home, and who stands in the way of those that
    cannot go home, or not without a push. What would leave blocks that can never move is no child.
    """
    spots = states.spot[row]
    for i in range(must_go.shape[0]):
        spot = spots[i]
        if spot == GOAL + i:
            continue
        clear(occupied, spot)
        stage, pair = way_home(i, spot, can_pick, occupied, tables)
        bound, detours, pushes = after_going_home(i, now, states.cycles[row], tables)
        if pair >= 0:
            pushes_out = pushes_out_left(i, GOAL + i, now.left, occupied, spots, can_pick, tables)
            bound, detours = NEVER if pushes_out == NEVER else bound, detours + pushes_out
        # A block is really on its way only if fewer actions are left then; otherwise it may have to wait.
        is_going = pair >= 0 and bound < now.bound
        # By way of a staging pose it takes two actions, put down and pushed, else one.
        if pair >= 0 and bound < NEVER and bound + 1 + (stage != NO_STAGE) <= limit:
            append(out, count, states, tables, row, i, GOAL + i, stage, pair)
            estimate(out, count, bound, states.cycles[row], detours, tables.push_price.extra * pushes)
            count += 1
        if not is_going or stage != NO_STAGE:
            note_obstacles(i, spot, occupied, tables, blocking)
        if not is_going:
            note_obstacles_of_pushes(i, occupied, tables, blocking)
        must_go[i] = not is_going and spot < POOL
        occupy(occupied, spot)
    return count


@njit(cache=True, inline="always")
def _make_way(
    states: States, row: int, i: int, occupied: Words, now: StateSummary, can_pick: Flags, options: Options,
    found: int, tables: Tables, limit: int, out: Children, count: int,
) -> int:  # fmt: skip
    """Append a child for every pose that was found for a block to wait at; the new number of children."""
    cycles_elsewhere, spots = cycles_with(i, NOWHERE, now, tables), states.spot[row]
    for option in range(found):
        end, cycles = options.spot[option], cycles_elsewhere
        # Only a pose on other blocks' goals can close a circle of blocks on each other's goals.
        if tables.crowds[end, 0] & now.left & ~bit(i):
            cycles = cycles_with(i, end, now, tables)
        bound, detours = after_making_way(i, end, now, cycles, tables)
        if bound + 1 > limit:
            continue
        pushes_out = pushes_out_left(i, end, now.left, occupied, spots, can_pick, tables)
        if pushes_out < NEVER:
            append(out, count, states, tables, row, i, end, NO_STAGE, options.grasps[option])
            # Pushes of interlocked blocks are a guess; what is left at least counts those into the grid.
            premium_left = tables.push_price.extra * now.pushes
            estimate(out, count, bound, cycles, detours + pushes_out, premium_left)
            count += 1
    return count
