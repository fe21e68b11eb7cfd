"""What cannot be done is proven, and what can be done is never called impossible."""

import pytest

from pack_core.blocks.plan import PlanStatus
from pack_evaluation.blocks.plan_verifier import verify
from pack_planner.rearrangement.certificates import find_certificate, unreachable
from pack_planner.rearrangement.instances import make_instance
from pack_planner.rearrangement.planning import plan
from pack_planner.rearrangement.snapped_problem import SnappedProblem

SIDE = 50.8
FAR = {"a": (200, 200), "b": (200, 100), "c": (200, 0), "d": (200, -100)}
CLUSTER = {"a": (0, 0), "b": (SIDE, 0), "c": (0, SIDE), "d": (SIDE, SIDE)}


def grid(ids: str, pitch: float = SIDE + 2) -> dict[str, tuple[float, float]]:
    return {name: (pitch * (i % 3), pitch * (i // 3)) for i, name in enumerate(ids)}


def test_four_touching_blocks_are_stuck(make) -> None:
    made = plan(make(CLUSTER, FAR))
    assert made.status is PlanStatus.INFEASIBLE
    assert set(made.diagnosis.blocks) == set("abcd")
    assert "stuck" in made.diagnosis.text


def test_three_touching_blocks_in_a_row_are_not_stuck(make) -> None:
    row = {"a": (0, 0), "b": (SIDE, 0), "c": (2 * SIDE, 0)}
    made = plan(make(row, {name: FAR[name] for name in row}))
    assert made.status is PlanStatus.OPTIMAL
    assert len(made.actions) == 3


def test_a_dense_grid_cannot_be_sorted(make) -> None:
    made = plan(make(grid("abcdefghi"), grid("bacdefghi")))
    assert made.status is PlanStatus.INFEASIBLE
    assert set(made.diagnosis.blocks) == set("abcdefghi")
    assert "a, b must move" in made.diagnosis.text


def test_a_hole_between_blocks_that_never_move_has_no_way_in(make) -> None:
    snapped = SnappedProblem.of(make(grid("abcdefghi")))
    middle = snapped.ids.index("e")
    assert unreachable(snapped, fixed=set(range(9)) - {middle}) == [middle]
    assert unreachable(snapped, fixed=set()) == []


def test_a_hole_in_a_finished_grid_is_opened_which_is_proven_optimal(make) -> None:
    """The block in the middle has no way in; a neighbour is put aside and pushed back."""
    goals = grid("abcdefghi")
    problem = make(dict(goals, e=(250, 250)), goals, size=0.7)
    made = plan(problem, budget_s=20.0)
    assert made.status is PlanStatus.OPTIMAL
    assert len(made.actions) == made.lower_bound == 4
    assert verify(problem, made) == []


@pytest.mark.parametrize("seed", range(30))
def test_random_instances_get_no_certificate(seed: int) -> None:
    assert find_certificate(SnappedProblem.of(make_instance(9, 0.2, seed))) is None
