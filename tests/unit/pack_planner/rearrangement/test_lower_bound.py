"""No plan is shorter than the lower bound."""

import pytest

from pack_core.blocks.problem import PlacedBlock
from pack_planner.rearrangement.beam.beam_planner import BeamPlanner
from pack_planner.rearrangement.instances import make_instance
from pack_planner.rearrangement.lower_bound import lower_bound, order_bound
from pack_planner.rearrangement.methods import RearrangementConfig
from pack_planner.rearrangement.planning import plan
from pack_planner.rearrangement.snapped_problem import SnappedProblem

SHORT = RearrangementConfig(beam=BeamPlanner(rounds=4))
PITCH = 52.8
SQUARE = {"a": (0, 0), "b": (PITCH, 0), "c": (0, PITCH), "d": (PITCH, PITCH)}


def bound(problem) -> int:
    return lower_bound(SnappedProblem.of(problem))


def test_every_block_away_counts_and_every_push_of_the_assembly() -> None:
    assert [bound(make_instance(n, 0.08, 0)) for n in (1, 2, 4, 6, 9, 12, 16)] == [1, 2, 5, 7, 11, 15, 21]


def test_groups_of_a_larger_grid_bound_it_together() -> None:
    assert bound(make_instance(30, 0.08, 0)) >= 30 + 6


def test_a_block_that_waits_on_its_push_line_takes_one_action(make) -> None:
    assert bound(make({**SQUARE, "d": (PITCH, PITCH + 40)}, SQUARE)) == 1
    assert bound(make({**SQUARE, "d": (PITCH + 5, PITCH + 40)}, SQUARE)) == 2


def test_moving_a_block_that_is_home_may_be_cheaper_than_the_pushes_it_forces(make) -> None:
    """Three at home force a push of the fourth: two actions, as many as putting one of the three aside."""
    assert bound(make({**SQUARE, "d": (200, 200)}, SQUARE)) == 2


def test_blocks_at_home_need_nothing(make) -> None:
    assert bound(make(SQUARE)) == 0


def test_two_blocks_that_stand_on_each_others_goals_take_three_actions(make) -> None:
    problem = make({"a": (0, 0), "b": (80, 0)}, {"a": (80, 0), "b": (0, 0)})
    assert bound(problem) == 2
    assert order_bound(SnappedProblem.of(problem)) == 3
    assert len(plan(problem, budget_s=20.0, config=SHORT).actions) == 3


@pytest.mark.parametrize(("n", "density"), [(4, 0.2), (4, 0.3), (6, 0.2), (6, 0.3)])
def test_no_plan_is_shorter_than_the_sharper_bound(n: int, density: float) -> None:
    sharper = 0
    for seed in range(6):
        problem = make_instance(n, density, seed)
        made = plan(problem, budget_s=20.0, seed=seed, config=SHORT)
        least = order_bound(SnappedProblem.of(problem))
        assert not made.is_solved or len(made.actions) >= least
        sharper += least > bound(problem)
    assert sharper > 0


def test_the_sharper_bound_counts_blocks_at_home_as_the_other_one_does(make) -> None:
    cells = {name: (PITCH * (i % 3), PITCH * (i // 3)) for i, name in enumerate("abcdefghi")}
    problem = make({**cells, "e": (250, 250)}, cells, size=0.7)
    assert order_bound(SnappedProblem.of(problem)) == bound(problem) == 4


def test_the_bound_does_not_depend_on_the_order_of_the_blocks() -> None:
    problem = make_instance(9, 0.2, 3)
    turned = type(problem)(tuple(reversed(problem.blocks)), problem.goals, problem.workspace)
    assert bound(problem) == bound(turned)
    assert isinstance(problem.blocks[0], PlacedBlock)
