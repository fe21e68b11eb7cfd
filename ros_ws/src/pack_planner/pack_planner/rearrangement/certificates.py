"""Proofs that there is no plan.

- Blocks are stuck where, one after the other, whatever can be grasped or pushed is taken away, and some
  remain: none of them can be the first to move, as taking others away only makes room.
- A grid cannot be assembled where, one after the other, whatever can come last is taken out of the finished
  grid, and some remain: whichever of them had come last found no way in, as filled goals only take room.

By the second the planner also sees which blocks that are home already bar the way to the rest of the grid.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations

import numpy as np

from pack_core.blocks.plan import Diagnosis
from pack_core.blocks.planar import QUARTER
from pack_planner.rearrangement.assembly import sets_of_others
from pack_planner.rearrangement.footprints import fingers, hits, outlines, sweeps
from pack_planner.rearrangement.snapped_problem import SnappedProblem

MOST = 3
"""Blocks freed together; if that does not do, all are that can move."""


def find_certificate(snapped: SnappedProblem) -> Diagnosis | None:
    """A proof that there is no plan; None where none of these proofs holds, which proves nothing."""
    stuck = immobile(snapped)
    if away := [i for i in stuck if not snapped.is_home[i]]:
        names = _names(snapped, stuck)
        return Diagnosis(
            f"stuck: none of {', '.join(names)} can be grasped or pushed, whatever the others do, and "
            f"{', '.join(_names(snapped, away))} must move",
            names,
        )
    if core := unreachable(snapped, fixed=set(stuck)):
        names = _names(snapped, core)
        return Diagnosis(
            f"the goals of {', '.join(names)} leave no way in for whichever of these blocks comes last", names
        )
    return None


def immobile(snapped: SnappedProblem) -> list[int]:
    """Blocks that cannot move, whatever the others do."""
    gripper, shapes = snapped.gripper, snapped.shapes
    headings = snapped.starts[:, 2, None] + QUARTER * np.arange(4)
    ends = np.repeat(snapped.starts[:, None], 4, axis=1)
    ends[..., 0] += gripper.min_push * np.cos(headings)
    ends[..., 1] += gripper.min_push * np.sin(headings)
    pushes = sweeps(ends, headings, gripper.min_push, shapes[:, None], gripper)[..., None, :]
    blocks = outlines(snapped.starts, shapes)
    picked, pushed = hits(fingers(snapped.starts, shapes, gripper), blocks), hits(pushes, blocks)
    ways = sets_of_others(np.concatenate([picked, pushed], axis=1))
    return _peeled(ways, fixed=set())


def unreachable(snapped: SnappedProblem, fixed: set[int]) -> list[int]:
    """Blocks whose goals cannot all be filled, in whatever order, when the `fixed` ones stand on theirs."""
    alternatives = zip(
        snapped.goal_access.place.alternatives, snapped.goal_access.push.alternatives, strict=True
    )
    ways = [[*place, *push] for place, push in alternatives]
    return _peeled(ways, fixed)


def _peeled(ways: list[list[int]], fixed: set[int]) -> list[int]:
    """Who remains, the fixed ones left out, when whoever has a way clear of the rest is taken away."""
    left = (1 << len(ways)) - 1
    before = 0
    while left != before:
        before = left
        for i, sets in enumerate(ways):
            if left >> i & 1 and i not in fixed and any(not way & left for way in sets):
                left &= ~(1 << i)
    return [i for i in range(len(ways)) if left >> i & 1 and i not in fixed]


def _names(snapped: SnappedProblem, blocks: list[int]) -> tuple[str, ...]:
    return tuple(sorted(snapped.ids[i] for i in blocks))


def with_blockers_released(snapped: SnappedProblem) -> SnappedProblem:
    """The problem with as few blocks as possible no longer home, so that the grid can be assembled."""
    home = {int(i) for i in np.flatnonzero(snapped.is_home)}
    if not home or not unreachable(snapped, fixed=home):
        return snapped
    movable = sorted(home - set(immobile(snapped)))
    for count in range(1, MOST + 1):
        for some in combinations(movable, count):
            if not unreachable(snapped, fixed=home - set(some)):
                return _freed(snapped, some)
    return _freed(snapped, tuple(movable))


def _freed(snapped: SnappedProblem, blocks: tuple[int, ...]) -> SnappedProblem:
    is_home = snapped.is_home.copy()
    is_home[list(blocks)] = False
    return replace(snapped, is_home=is_home)
