"""Proofs that there is no plan.

- Blocks are stuck where, one after the other, whatever can be grasped or pushed is taken away, and some
  remain: none of them can be the first to move, as taking others away only makes room.
- A grid cannot be assembled where, one after the other, whatever can come last is taken out of the finished
  grid, and some remain: whichever of them had come last found no way in, as filled goals only take room.
"""

from __future__ import annotations

import numpy as np

from pack_core.blocks.plan import Diagnosis
from pack_core.blocks.planar import QUARTER
from pack_planner.rearrangement.collisions import hits
from pack_planner.rearrangement.footprints import fingers, squares, sweeps
from pack_planner.rearrangement.goal_access import sets_of_others
from pack_planner.rearrangement.task import Task


def find_certificate(task: Task) -> Diagnosis | None:
    """A proof that there is no plan; None where none of these proofs holds, which proves nothing."""
    stuck = immobile(task)
    if away := [i for i in stuck if not task.is_home[i]]:
        names = _names(task, stuck)
        return Diagnosis(
            f"stuck: none of {', '.join(names)} can be grasped or pushed, whatever the others do, and "
            f"{', '.join(_names(task, away))} must move",
            names,
        )
    if core := unreachable(task, fixed=set(stuck)):
        names = _names(task, core)
        return Diagnosis(
            f"the goals of {', '.join(names)} leave no way in for whichever of these blocks comes last", names
        )
    return None


def immobile(task: Task) -> list[int]:
    """Blocks that cannot move, whatever the others do."""
    gripper, side = task.gripper, task.side
    headings = task.starts[:, 2, None] + QUARTER * np.arange(4)
    ends = np.repeat(task.starts[:, None], 4, axis=1)
    ends[..., 0] += gripper.min_push * np.cos(headings)
    ends[..., 1] += gripper.min_push * np.sin(headings)
    pushes = sweeps(ends, headings, gripper.min_push, side, gripper)[..., None, :]
    blocks = squares(task.starts, side)
    picked, pushed = hits(fingers(task.starts, side, gripper), blocks), hits(pushes, blocks)
    ways = sets_of_others(np.concatenate([picked, pushed], axis=1))
    return _peeled(ways, fixed=set())


def unreachable(task: Task, fixed: set[int]) -> list[int]:
    """Blocks whose goals cannot all be filled, in whatever order, when the `fixed` ones stand on theirs."""
    alternatives = zip(task.goal_access.place.alternatives, task.goal_access.push.alternatives, strict=True)
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


def _names(task: Task, blocks: list[int]) -> tuple[str, ...]:
    return tuple(sorted(task.ids[i] for i in blocks))
