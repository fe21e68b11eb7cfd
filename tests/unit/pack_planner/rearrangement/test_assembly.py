"""The assembly pattern database against counts that are known, and against plain recursion."""

from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pack_core.blocks.problem import PlacedBlock, Problem
from pack_planner.rearrangement.assembly import NEVER, PLANES, BlockingSets, assembly_planes, pushes
from pack_planner.rearrangement.instances import goal_grid, square_workspace
from pack_planner.rearrangement.snapped_problem import SnappedProblem


def snapped_grid(n: int, gap: float) -> SnappedProblem:
    goals = {f"b{i}": pose for i, pose in enumerate(goal_grid(n, gap=gap))}
    blocks = tuple(PlacedBlock(name, pose) for name, pose in goals.items())
    return SnappedProblem.of(Problem(blocks, goals, square_workspace(2.0)))


def pushes_of_grid(n: int, gap: float) -> int:
    ways = snapped_grid(n, gap).goal_access
    return pushes(assembly_planes(ways.place, ways.push), np.uint64(0))


@pytest.mark.parametrize(
    ("n", "expected"), [(1, 0), (2, 0), (3, 0), (4, 1), (6, 1), (9, 2), (12, 3), (16, 5), (20, 6)]
)
def test_a_dense_grid_needs_a_push_for_every_block_that_closes_a_corner(n: int, expected: int) -> None:
    assert pushes_of_grid(n, gap=0.002) == expected


@pytest.mark.parametrize("n", [4, 9, 16])
def test_a_grid_as_wide_as_the_fingers_needs_no_push(n: int) -> None:
    assert pushes_of_grid(n, gap=0.0225) == 0
    assert pushes_of_grid(n, gap=0.0215) > 0


SETS = st.lists(st.lists(st.integers(0, 255), min_size=1, max_size=3), min_size=8, max_size=8)


@settings(max_examples=60)
@given(SETS, SETS)
def test_the_database_is_what_plain_recursion_finds(place: list[list[int]], push: list[list[int]]) -> None:
    n = len(place)
    ways = [[[s & ~(1 << i) for s in sets] for i, sets in enumerate(rows)] for rows in (place, push)]
    planes = assembly_planes(BlockingSets.of(ways[0]), BlockingSets.of(ways[1]))

    @cache
    def least(filled: int) -> int:
        if filled == (1 << n) - 1:
            return 0
        costs = [NEVER]
        for i in range(n):
            if not filled >> i & 1:
                for cost, rows in enumerate(ways):
                    if any(not s & filled for s in rows[i]):
                        costs.append(cost + least(filled | 1 << i))
        return min(*costs, NEVER)

    for filled in range(1 << n):
        assert pushes(planes, np.uint64(filled)) == least(filled)


def test_many_pushes_are_counted_up_to_the_last_plane() -> None:
    row = PLANES + 3
    alone = BlockingSets.of([[(1 << row) - 1 & ~(1 << i)] for i in range(row)])
    free = BlockingSets.of([[0] for _ in range(row)])
    assert pushes(assembly_planes(alone, free), np.uint64(0)) == PLANES - 1
