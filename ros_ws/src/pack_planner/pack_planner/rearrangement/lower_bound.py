"""How many actions every plan has at least.

Order the blocks by their last action. Those before stand on their goals then, so the last action of a block
is a push wherever it finds no room to be put down among them; and a pushed block takes an action before, to
get onto its push line, unless it starts on it. So there is one action for every block that is away from its
goal, and one for every push that the assembly needs. A block that is at home may be moved as well, for two
actions, and then need not have been there first.

For few blocks there is a sharper bound, `order_bound`, which considers the starts as well. Call single those
blocks that take one action, which leads from start to goal. While a block is brought home, those before it
stand on their goals and the singles after it on their starts; the others are taken to be nowhere, which only
helps. So a set of blocks can be single only if there is an order in which each finds room; the largest such
set is found by dynamic programming over all pairs of a set of blocks that are home and a set of singles still
to come, 3^n of them.
"""

from __future__ import annotations

from itertools import combinations, pairwise

import numpy as np
import numpy.typing as npt
from numba import njit

from pack_core.blocks.planar import QUARTER
from pack_core.rotations import Array
from pack_planner.rearrangement.assembly import MAX_GOALS, NEVER, PLANES, assembly_planes, pushes
from pack_planner.rearrangement.footprints import Words, fingers, hits, outlines, placings, sweeps
from pack_planner.rearrangement.snapped_problem import SnappedProblem

MOST_BLOCKS = 10
"""For which the dynamic programme takes a few milliseconds."""
GOALS = 32
"""First bit of the goals in a word; starts come before."""
IMPOSSIBLE = np.uint64(2**64 - 1)
"""Instead of a set: all bits, which no set of blocks that are in the way has."""


def lower_bound(snapped: SnappedProblem) -> int:
    """Actions that every plan takes; only of use for a problem without a certificate that there is none."""
    away = int((~snapped.is_home).sum())
    if not away:
        return 0
    place, push = snapped.goal_access.place, snapped.goal_access.push
    home = sum(1 << int(i) for i in np.flatnonzero(snapped.is_home))
    parts = -(-snapped.n // MAX_GOALS)
    cuts = [snapped.n * part // parts for part in range(parts + 1)]
    needed = 0
    for first, end in pairwise(cuts):
        planes = assembly_planes(place.within(first, end - first), push.within(first, end - first))
        needed += _pushes_with_moves(planes, home >> first & ((1 << end - first) - 1))
    return away + max(needed - int(snapped.is_ready.sum()), 0)


def sharper_bound(snapped: SnappedProblem, bound: int) -> int:
    """The larger of a lower bound and, for few blocks, the one that takes some milliseconds to find."""
    return max(bound, order_bound(snapped)) if snapped.n <= MOST_BLOCKS else bound


def _pushes_with_moves(planes: Words, home: int) -> int:
    """Actions beyond one a block: pushes of an assembly that starts with the goals `home`, or with fewer."""
    goals = [i for i in range(home.bit_length()) if home >> i & 1]
    least = pushes(planes, np.uint64(home))
    for moved in range(1, 3):
        for some in combinations(goals, moved):
            left = home & ~sum(1 << i for i in some)
            least = min(least, 2 * moved + max(pushes(planes, np.uint64(left)) - moved, 0))
    return int(min(least, PLANES - 1, 2 * 3 if len(goals) >= 3 else NEVER))


def order_bound(snapped: SnappedProblem) -> int:
    """Actions that every plan of up to MOST_BLOCKS blocks takes."""
    once, finally_ = _ways(snapped)
    can_finish = _can_finish(once, finally_)
    home = [int(i) for i in np.flatnonzero(snapped.is_home)]
    away = snapped.n - len(home)
    bounds = [3 * 2 + away] if len(home) >= 3 else []
    for moved in range(min(len(home), 2) + 1):
        for some in combinations(home, moved):
            standing = sum(1 << i for i in home if i not in some)
            others = sum(1 << i for i in range(snapped.n) if not snapped.is_home[i])
            singles = _largest(can_finish[standing], others)
            if singles >= 0:
                bounds.append(2 * moved + 2 * away - singles)
    return min(bounds, default=0)


def _largest(can_finish: npt.NDArray[np.bool_], allowed: int) -> int:
    """Size of the largest set of singles with which the rest can be finished; -1 for none."""
    sets = np.flatnonzero(can_finish)
    sets = sets[sets & ~allowed == 0]
    return int(np.bitwise_count(sets).max()) if len(sets) else -1


def _ways(snapped: SnappedProblem) -> tuple[Words, Words]:
    """Alternatives `(n, ways)` of what must not be there: for a single action, and for a last action."""
    n, shapes, gripper = snapped.n, snapped.shapes, snapped.gripper
    blocks = np.full((GOALS + n, 6), 1e6)
    blocks[:n], blocks[GOALS:] = outlines(snapped.starts, shapes), outlines(snapped.goals, shapes)
    pick = hits(fingers(snapped.starts, shapes, gripper), blocks)[..., 0]
    place = hits(placings(snapped.goals, shapes, gripper), blocks)[..., 0]
    push = hits(_pushes(snapped, np.zeros(n)), blocks)[..., 0]
    is_symmetric = snapped.problem.symmetry == 4
    carried = [pick[:, k] | place[:, end] for k in range(2) for end in range(2) if k == end or is_symmetric]
    pushed = hits(_pushes(snapped, _distances(snapped)), blocks)[..., 0]
    pushed[~_is_pushed_from_start(snapped)] = IMPOSSIBLE
    once = np.concatenate([np.stack(carried, axis=1), pushed], axis=1)
    own = (np.uint64(1) << np.arange(n, dtype=np.uint64)) * np.uint64(1 + (1 << GOALS))
    return _without(once, own), _without(np.concatenate([place, push], axis=1), own)


def _without(words: Words, own: Words) -> Words:
    return np.where(words == IMPOSSIBLE, IMPOSSIBLE, words & ~own[:, None])


def _headings(snapped: SnappedProblem) -> Array:
    return np.asarray(snapped.goals[:, 2, None] + QUARTER * np.arange(4))


def _pushes(snapped: SnappedProblem, distances: Array) -> Array:
    """Footprints `(n, 4, 1, 6)` of pushes into the goals."""
    ends = np.repeat(snapped.goals[:, None], 4, axis=1)
    shapes = snapped.shapes[:, None]
    return sweeps(ends, _headings(snapped), distances[:, None], shapes, snapped.gripper)[..., None, :]


def _distances(snapped: SnappedProblem) -> Array:
    return np.asarray(np.hypot(*(snapped.goals - snapped.starts)[:, :2].T))


def _is_pushed_from_start(snapped: SnappedProblem) -> npt.NDArray[np.bool_]:
    """Blocks that stand on their push lines, and the heading of that push `(n, 4)`."""
    offset = (snapped.goals - snapped.starts)[:, None, :2]
    headings = _headings(snapped)
    along = np.stack([np.cos(headings), np.sin(headings)], axis=-1)
    ahead = np.sum(offset * along, axis=-1)
    return np.asarray(snapped.is_ready[:, None] & (np.abs(ahead - _distances(snapped)[:, None]) < 1e-6))


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
