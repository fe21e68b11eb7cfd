"""Who stands between a block and its goal, compiled."""

from __future__ import annotations

import numpy as np
from numba import njit

from pack_planner.rearrangement.beam.spots import GOAL
from pack_planner.rearrangement.beam.tables import Tables
from pack_planner.rearrangement.collisions import Words


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
