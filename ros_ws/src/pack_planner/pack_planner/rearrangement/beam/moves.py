"""How a block can be carried home, who hinders it, and where it may go that must make way; compiled."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from numba import njit

from pack_core.rotations import Array
from pack_planner.rearrangement.beam.estimates import StateSummary
from pack_planner.rearrangement.beam.spots import GOAL, NO_GO, NO_SPOT, Ints
from pack_planner.rearrangement.beam.states import NO_STAGE, PUSHED, bit, count_bits, has
from pack_planner.rearrangement.beam.tables import Tables
from pack_planner.rearrangement.footprints import Words, is_free

Flags = npt.NDArray[np.bool_]
LOOKED_AT = 2
"""Free buffer poses that are compared for every one that is tried."""
OFF_LINE = 1.0
"""Cost of a buffer pose that is on no push line of the block, in goals stood on."""
CROWDED = 0.3
"""Cost of a goal that is left without a grasp."""
PER_METRE = 0.5
"""Cost of a metre of the way, in goals stood on: the way decides between poses that are alike otherwise."""


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


@njit(cache=True, inline="always")
def note_obstacles(i: int, spot: int, occupied: Words, tables: Tables, blocking: Words) -> None:
    """Add to `blocking` the spots whose blocks hinder block i from being carried home."""
    push = tables.push_of[i, spot]
    for w in range(occupied.shape[0]):
        for k in range(2):
            blocking[w] |= (tables.pick[spot, k, w] | tables.place[GOAL + i, k, w]) & occupied[w]
        if push >= 0:
            blocking[w] |= tables.push[push, w] & occupied[w]


@njit(cache=True, inline="always")
def note_obstacles_of_pushes(i: int, occupied: Words, tables: Tables, blocking: Words) -> None:
    """Add the spots that are in the way of block i's shortest pushes that no filled goal prevents."""
    for m in range(4):
        if not (tables.stage_push[i, m, 0] & occupied[0]) >> np.uint64(GOAL):
            for w in range(occupied.shape[0]):
                place = tables.stage_place[i, m, 0, w] | tables.stage_place[i, m, 1, w]
                blocking[w] |= (tables.stage_push[i, m, w] | place) & occupied[w]


class Options(NamedTuple):
    """Room for buffer poses `(room,)` and the grasps to get there, as in Children; costs `(breadth,)`."""

    spot: Ints
    grasps: Ints
    cost: Array


@njit(cache=True, inline="always")
def buffer_options(
    i: int, spots: npt.NDArray[np.int16], can_pick: npt.NDArray[np.bool_], now: StateSummary, is_tight: bool,
    order: Ints, tables: Tables, options: Options,
) -> int:  # fmt: skip
    """Fill `options` with the best of the first free buffer poses in order; how many there are.

    Where there is no action to spare, `is_tight`, only a pose from which the block is pushed home will do.
    """
    start, breadth = spots[i], options.cost.shape[0]
    free = _free_spots(i, spots, tables.denied)
    possible = free[0] | free[1]
    found, looked = 0, 0
    for rank in range(order.shape[1]):
        spot = order[i, rank]
        if spot == NO_SPOT:
            break
        if spot == start or not has(possible, spot) or (is_tight and tables.push_of[i, spot] < 0):
            continue
        pair = _grasps(i, start, spot, can_pick, free, tables)
        if pair < 0:
            continue
        cost = _cost(i, spot, start, now.left, tables)
        if found < breadth:
            place = found
            found += 1
        else:
            place = _dearest(options.cost)
        if looked < breadth or cost < options.cost[place]:
            options.spot[place], options.grasps[place], options.cost[place] = spot, pair, cost
        looked += 1
        if looked == LOOKED_AT * breadth:
            break
    return found


@njit(cache=True, inline="always")
def pushed_out_options(i: int, occupied: Words, tables: Tables, options: Options) -> int:
    """Fill `options` with the poses that block i can be pushed to from its start; how many there are."""
    found = 0
    for row in range(tables.out_first[i], tables.out_first[i + 1]):
        is_clear = True
        for w in range(occupied.shape[0]):
            is_clear &= not tables.out[row, w] & occupied[w]
        if is_clear:
            options.spot[found], options.grasps[found] = tables.out_spot[row], PUSHED
            found += 1
    return found


@njit(cache=True)
def _free_spots(i: int, spots: npt.NDArray[np.int16], denied: Words) -> Words:
    """Spots on which block i can be put down, the gripper closing along either axis `(2, W)`."""
    words: Words = denied[NO_GO].copy()
    for j in range(spots.shape[0]):
        if j != i:
            for k in range(2):
                for w in range(denied.shape[2]):
                    words[k, w] |= denied[spots[j], k, w]
    return ~words


@njit(cache=True, inline="always")
def _grasps(
    i: int, start: int, spot: int, can_pick: npt.NDArray[np.bool_], free: Words, tables: Tables
) -> int:
    """The pair of grasps by which a block can be carried to a buffer pose; -1 for none."""
    pair = -1
    swap = swaps(i, start, spot, tables)
    for turned in range(1 + tables.is_symmetric):
        for k in range(2):
            end = k ^ swap ^ turned
            is_free = (free[end, spot // 64] >> np.uint64(spot % 64)) & np.uint64(1)
            if pair < 0 and can_pick[i, k] and is_free:
                pair = 2 * k + end
    return pair


@njit(cache=True, inline="always")
def _cost(i: int, spot: int, start: int, left: np.uint64, tables: Tables) -> float:
    """How much a buffer pose is in the way of goals not filled yet; less on the block's own push line."""
    others = left & ~bit(i)
    stood_on, crowded = tables.crowds[spot, 0] & others, tables.crowds[spot, 1] & others
    dx = tables.poses[spot, 0] - tables.poses[start, 0]
    dy = tables.poses[spot, 1] - tables.poses[start, 1]
    way = math.sqrt(dx * dx + dy * dy)
    line = OFF_LINE if tables.push_of[i, spot] < 0 else _price_of_length(i, spot, tables)
    return float(count_bits(stood_on) + CROWDED * count_bits(crowded) + line + PER_METRE * way)


@njit(cache=True, inline="always")
def _price_of_length(i: int, spot: int, tables: Tables) -> float:
    """What the length of the push from a spot into block i's goal costs; 0.0 where lengths have no price."""
    dx = tables.poses[GOAL + i, 0] - tables.poses[spot, 0]
    dy = tables.poses[GOAL + i, 1] - tables.poses[spot, 1]
    return float(tables.push_price.per_metre * math.sqrt(dx * dx + dy * dy))


@njit(cache=True, inline="always")
def _dearest(costs: Array) -> int:
    dearest = 0
    for option in range(1, costs.shape[0]):
        if costs[option] > costs[dearest]:
            dearest = option
    return dearest
