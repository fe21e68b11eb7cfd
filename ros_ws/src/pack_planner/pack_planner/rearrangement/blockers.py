"""Blocks that are home already, but where they bar the way to the rest of the grid."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations

import numpy as np

from pack_planner.rearrangement.certificates import immobile, unreachable
from pack_planner.rearrangement.task import Task

MOST = 3
"""Blocks freed together; if that does not do, all are that can move."""


def with_blockers_released(task: Task) -> Task:
    """The task with as few blocks as possible no longer home, so that the grid can be assembled."""
    home = {int(i) for i in np.flatnonzero(task.is_home)}
    if not home or not unreachable(task, fixed=home):
        return task
    movable = sorted(home - set(immobile(task)))
    for count in range(1, MOST + 1):
        for some in combinations(movable, count):
            if not unreachable(task, fixed=home - set(some)):
                return _freed(task, some)
    return _freed(task, tuple(movable))


def _freed(task: Task, blocks: tuple[int, ...]) -> Task:
    is_home = task.is_home.copy()
    is_home[list(blocks)] = False
    return replace(task, is_home=is_home)
