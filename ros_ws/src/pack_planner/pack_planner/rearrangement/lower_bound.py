"""How many actions every plan has at least.

Order the blocks by their last action. Those before stand on their goals then, so the last action of a block
is a push wherever it finds no room to be put down among them; and a pushed block takes an action before, to
get onto its push line, unless it starts on it. So there is one action for every block that is away from its
goal, and one for every push that the assembly needs. A block that is at home may be moved as well, for two
actions, and then need not have been there first.
"""

from __future__ import annotations

from itertools import combinations, pairwise

import numpy as np

from pack_planner.rearrangement.assembly import MAX_GOALS, NEVER, PLANES, assembly_planes, pushes
from pack_planner.rearrangement.collisions import Words
from pack_planner.rearrangement.order_bound import MOST_BLOCKS, order_bound
from pack_planner.rearrangement.task import Task


def lower_bound(task: Task) -> int:
    """Actions that every plan takes; only of use for a task without a certificate that there is none."""
    away = int((~task.is_home).sum())
    if not away:
        return 0
    place, push = task.goal_access.place, task.goal_access.push
    home = sum(1 << int(i) for i in np.flatnonzero(task.is_home))
    parts = -(-task.n // MAX_GOALS)
    cuts = [task.n * part // parts for part in range(parts + 1)]
    needed = 0
    for first, end in pairwise(cuts):
        planes = assembly_planes(place.within(first, end - first), push.within(first, end - first))
        needed += _pushes_with_moves(planes, home >> first & ((1 << end - first) - 1))
    return away + max(needed - int(task.is_ready.sum()), 0)


def sharper_bound(task: Task, bound: int) -> int:
    """The larger of a lower bound and, for few blocks, the one that takes some milliseconds to find."""
    return max(bound, order_bound(task)) if task.n <= MOST_BLOCKS else bound


def _pushes_with_moves(planes: Words, home: int) -> int:
    """Actions beyond one a block: pushes of an assembly that starts with the goals `home`, or with fewer."""
    goals = [i for i in range(home.bit_length()) if home >> i & 1]
    least = pushes(planes, np.uint64(home))
    for moved in range(1, 3):
        for some in combinations(goals, moved):
            left = home & ~sum(1 << i for i in some)
            least = min(least, 2 * moved + max(pushes(planes, np.uint64(left)) - moved, 0))
    return int(min(least, PLANES - 1, 2 * 3 if len(goals) >= 3 else NEVER))
