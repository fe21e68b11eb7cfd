"""Moves after which some block can never move again, or not before a push, are seen, and no others."""

import numpy as np
import numpy.typing as npt
import pytest

from pack_planner.rearrangement.assembly import NEVER
from pack_planner.rearrangement.beam.estimates import pushes_out_left
from pack_planner.rearrangement.beam.spots import GOAL, POOL, buffer_pool
from pack_planner.rearrangement.beam.tables import Tables, build_tables
from pack_planner.rearrangement.instances import make_instance
from pack_planner.rearrangement.snapped_problem import SnappedProblem

Spots = npt.NDArray[np.int16]
N = 25


@pytest.mark.parametrize(("seed", "kind"), [(17, "stuck"), (20, "stuck"), (74, "interlocked")])
def test_interlocked_blocks_are_what_taking_blocks_away_one_by_one_leaves(seed: int, kind: str) -> None:
    """Blocks are carried about at random, home wherever they find room, on and on."""
    rng = np.random.default_rng(seed)
    snapped = SnappedProblem.of(make_instance(N, 0.2, seed))
    tables = build_tables(snapped, buffer_pool(snapped, 64, rng))
    spots, found = np.arange(N, dtype=np.int16), {"stuck": 0, "interlocked": 0}
    for _ in range(800):
        i = int(rng.integers(N))
        end = carried(i, spots, tables, rng)
        if end is None:
            continue
        after = spots.copy()
        after[i] = end
        stuck, interlocked = (
            remaining(after, tables, pushed_out=True),
            remaining(after, tables, pushed_out=False),
        )
        pushes = seen(i, end, spots, tables)
        assert (pushes == NEVER) == bool(stuck)
        assert (pushes == 0) == (not interlocked)
        assert pushes == NEVER or pushes <= len(interlocked)
        found["stuck"] += bool(stuck)
        found["interlocked"] += bool(interlocked) and not stuck
        is_over = stuck or (after >= GOAL).sum() > N - 3
        spots = np.arange(N, dtype=np.int16) if is_over else after
    assert found[kind] > 0


def seen(i: int, end: int, spots: Spots, tables: Tables) -> int:
    left = np.uint64(sum(1 << j for j in range(N) if spots[j] != GOAL + j))
    can_pick = np.array(
        [[is_clear(tables.pick[spots[j], k], spots, {j}) for k in range(2)] for j in range(N)]
    )
    occupied = np.zeros(tables.pick.shape[2], dtype=np.uint64)
    for spot in spots.tolist():
        occupied[spot // 64] |= np.uint64(1) << np.uint64(spot % 64)
    return int(pushes_out_left(i, end, left, occupied, spots, can_pick, tables))


def carried(i: int, spots: Spots, tables: Tables, rng: np.random.Generator) -> int | None:
    """A spot to which block i can be carried: its goal, or one of some buffer poses."""
    if spots[i] == GOAL + i or not any(is_clear(tables.pick[spots[i], k], spots, {i}) for k in range(2)):
        return None
    for end in (GOAL + i, *rng.integers(POOL, len(tables.poses), 4).tolist()):
        if any(is_clear(tables.place[end, k], spots, {i}) for k in range(2)):
            return int(end)
    return None


def remaining(spots: Spots, tables: Tables, *, pushed_out: bool) -> set[int]:
    """Blocks away from their goals that stay when what can leave is taken away, again and again."""
    gone: set[int] = set()
    left = {j for j in range(N) if spots[j] != GOAL + j}
    while leaving := {j for j in left if can_leave(j, spots, tables, gone, pushed_out)}:
        gone |= leaving
        left -= leaving
    return left


def can_leave(j: int, spots: Spots, tables: Tables, gone: set[int], pushed_out: bool) -> bool:
    rows = [*tables.pick[spots[j]]]
    if tables.push_of[j, spots[j]] >= 0:
        rows.append(tables.push[tables.push_of[j, spots[j]]])
    if pushed_out and spots[j] == j:
        rows += [*tables.out[tables.out_first[j] : tables.out_first[j + 1]]]
    return any(is_clear(row, spots, {j} | gone) for row in rows)


def is_clear(row: npt.NDArray[np.uint64], spots: Spots, without: set[int]) -> bool:
    words = row.tolist()
    return not any(words[s // 64] >> (s % 64) & 1 for j, s in enumerate(spots.tolist()) if j not in without)
