"""A sharper lower bound for few blocks: who can go home in one action, considering the starts as well.

Order the blocks by their last action, and call single those that take one action, which leads from start to
goal. While a block is brought home, those before it stand on their goals and the singles after it on their
starts; the others are taken to be nowhere, which only helps. So a set of blocks can be single only if there
is an order in which each finds room; the largest such set is found by dynamic programming over all pairs of
a set of blocks that are home and a set of singles still to come, 3^n of them.
"""

from __future__ import annotations

from itertools import combinations

import numpy as np
import numpy.typing as npt
from numba import njit

from pack_core.blocks.planar import QUARTER
from pack_core.rotations import Array
from pack_planner.rearrangement.collisions import Words, hits
from pack_planner.rearrangement.footprints import fingers, placings, squares, sweeps
from pack_planner.rearrangement.task import Task

MOST_BLOCKS = 10
"""For which the dynamic programme takes a few milliseconds."""
GOALS = 32
"""First bit of the goals in a word; starts come before."""
NEVER = np.uint64(2**64 - 1)


def order_bound(task: Task) -> int:
    """Actions that every plan of up to MOST_BLOCKS blocks takes."""
    once, finally_ = _ways(task)
    can_finish = _can_finish(once, finally_)
    home = [int(i) for i in np.flatnonzero(task.is_home)]
    away = task.n - len(home)
    bounds = [3 * 2 + away] if len(home) >= 3 else []
    for moved in range(min(len(home), 2) + 1):
        for some in combinations(home, moved):
            standing = sum(1 << i for i in home if i not in some)
            others = sum(1 << i for i in range(task.n) if not task.is_home[i])
            singles = _largest(can_finish[standing], others)
            if singles >= 0:
                bounds.append(2 * moved + 2 * away - singles)
    return min(bounds, default=0)


def _largest(can_finish: npt.NDArray[np.bool_], allowed: int) -> int:
    """Size of the largest set of singles with which the rest can be finished; -1 for none."""
    sets = np.flatnonzero(can_finish)
    sets = sets[sets & ~allowed == 0]
    return int(np.bitwise_count(sets).max()) if len(sets) else -1


def _ways(task: Task) -> tuple[Words, Words]:
    """Alternatives `(n, ways)` of what must not be there: for a single action, and for a last action."""
    n, side, gripper = task.n, task.side, task.gripper
    blocks = np.full((GOALS + n, 6), 1e6)
    blocks[:n], blocks[GOALS:] = squares(task.starts, side), squares(task.goals, side)
    pick = hits(fingers(task.starts, side, gripper), blocks)[..., 0]
    place = hits(placings(task.goals, side, gripper), blocks)[..., 0]
    push = hits(_pushes(task, np.zeros(n)), blocks)[..., 0]
    is_symmetric = task.problem.symmetry == 4
    carried = [pick[:, k] | place[:, end] for k in range(2) for end in range(2) if k == end or is_symmetric]
    pushed = hits(_pushes(task, _distances(task)), blocks)[..., 0]
    pushed[~_is_pushed_from_start(task)] = NEVER
    once = np.concatenate([np.stack(carried, axis=1), pushed], axis=1)
    own = (np.uint64(1) << np.arange(n, dtype=np.uint64)) * np.uint64(1 + (1 << GOALS))
    return _without(once, own), _without(np.concatenate([place, push], axis=1), own)


def _without(words: Words, own: Words) -> Words:
    return np.where(words == NEVER, NEVER, words & ~own[:, None])


def _headings(task: Task) -> Array:
    return np.asarray(task.goals[:, 2, None] + QUARTER * np.arange(4))


def _pushes(task: Task, distances: Array) -> Array:
    """Footprints `(n, 4, 1, 6)` of pushes into the goals."""
    ends = np.repeat(task.goals[:, None], 4, axis=1)
    return sweeps(ends, _headings(task), distances[:, None], task.side, task.gripper)[..., None, :]


def _distances(task: Task) -> Array:
    return np.asarray(np.hypot(*(task.goals - task.starts)[:, :2].T))


def _is_pushed_from_start(task: Task) -> npt.NDArray[np.bool_]:
    """Blocks that stand on their push lines, and the heading of that push `(n, 4)`."""
    offset = (task.goals - task.starts)[:, None, :2]
    headings = _headings(task)
    along = np.stack([np.cos(headings), np.sin(headings)], axis=-1)
    ahead = np.sum(offset * along, axis=-1)
    return np.asarray(task.is_ready[:, None] & (np.abs(ahead - _distances(task)[:, None]) < 1e-6))


@njit(cache=True)
def _can_finish(once: Words, last: Words) -> npt.NDArray[np.bool_]:
    """For every set of blocks at home, and every set of singles still to come: whether all can come home.

    Args:
        once: alternatives for a single action `(n, ways)`: starts and goals that it would hit.
        last: alternatives for the last of several actions `(n, ways)`.
    """
    n = once.shape[0]
    everyone = (1 << n) - 1
    table = np.zeros((1 << n, 1 << n), dtype=np.bool_)
    table[everyone, 0] = True
    for home in range(everyone - 1, -1, -1):
        rest = everyone & ~home
        singles = rest
        while True:
            for i in range(n):
                if rest >> i & 1 and not table[home, singles]:
                    then = singles & ~(1 << i)
                    there = np.uint64(then) | np.uint64(home) << np.uint64(GOALS)
                    ways = once if singles >> i & 1 else last
                    if table[home | 1 << i, then] and _finds_room(ways, i, there):
                        table[home, singles] = True
            if singles == 0:
                break
            singles = (singles - 1) & rest
    return table


@njit(cache=True, inline="always")
def _finds_room(ways: Words, i: int, there: np.uint64) -> bool:
    found = False
    for way in range(ways.shape[1]):
        found |= ways[i, way] & there == 0
    return found
