"""Random problems keep what they promise."""

from itertools import combinations, pairwise

import numpy as np
import pytest
from shapely import Polygon

from pack_core.blocks.problem import CUBE, CUBE_SIDE
from pack_core.errors import PackError
from pack_planner.rearrangement.footprints import corners_of, rows_of, signed_area
from pack_planner.rearrangement.instances import GRID_GAP, START_GAP, goal_grid, make_instance, workspace_side
from pack_planner.rearrangement.validation import find_fault


def test_the_same_numbers_give_the_same_instance() -> None:
    assert make_instance(9, 0.2, 3).blocks == make_instance(9, 0.2, 3).blocks
    assert dict(make_instance(9, 0.2, 3).goals) == dict(make_instance(9, 0.2, 3).goals)
    assert make_instance(9, 0.2, 4).blocks != make_instance(9, 0.2, 3).blocks


@pytest.mark.parametrize(("n", "density"), [(4, 0.08), (9, 0.2), (16, 0.3), (25, 0.2)])
def test_blocks_cover_the_stated_share_and_stand_apart(n: int, density: float) -> None:
    problem = make_instance(n, density, seed=1, centre=(0.65, -0.1))
    assert n * CUBE_SIDE**2 / signed_area(problem.workspace) == pytest.approx(density)
    assert find_fault(problem) is None
    corners = corners_of(rows_of(problem.starts.values()), CUBE)
    distances = [a.distance(b) for a, b in combinations(map(Polygon, corners), 2)]
    assert min(distances) >= START_GAP
    assert np.mean(rows_of(problem.goals.values())[:, :2], axis=0) == pytest.approx((0.65, -0.1))


def test_a_large_workspace_of_nine_blocks_is_54_cm_wide() -> None:
    assert workspace_side([CUBE] * 9, 0.08) == pytest.approx(0.539, abs=1e-3)


def test_grids_are_as_square_as_the_number_allows() -> None:
    for n, rows in ((4, 2), (6, 2), (9, 3), (12, 3), (20, 4), (25, 5)):
        assert len({round(pose.y, 6) for pose in goal_grid(n)}) == rows


def test_a_density_that_leaves_no_room_is_refused_in_words() -> None:
    with pytest.raises(PackError, match="does not fit"):
        make_instance(9, 0.95, 0)


@pytest.mark.parametrize("seed", range(5))
def test_mixed_blocks_stand_in_rows_with_the_grid_s_gap_between_them(seed: int) -> None:
    problem = make_instance(9, 0.2, seed, mixed=True)
    assert find_fault(problem) is None
    area = sum(size.x * size.y for size in problem.sizes.values())
    assert area / signed_area(problem.workspace) == pytest.approx(0.2)
    rows: dict[float, list[tuple[float, float]]] = {}
    for name, goal in problem.goals.items():
        half = problem.sizes[name].x / 2
        rows.setdefault(round(goal.y, 6), []).append((goal.x - half, goal.x + half))
    assert len(rows) == 3
    for row in rows.values():
        row.sort()
        gaps = [after[0] - before[1] for before, after in pairwise(row)]
        assert gaps == pytest.approx([GRID_GAP, GRID_GAP])


def test_a_mixed_instance_is_another_one_than_that_of_cubes() -> None:
    assert make_instance(9, 0.2, 3, mixed=True).starts != make_instance(9, 0.2, 3).starts
    assert make_instance(9, 0.2, 3, mixed=True) == make_instance(9, 0.2, 3, mixed=True)
