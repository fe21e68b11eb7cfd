"""Plans of both methods: valid, short, repeatable, and honest about what is not known."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from pack_core.blocks.plan import PickPlace, PlanStatus, Push
from pack_core.blocks.planar import PlanarPose
from pack_core.blocks.primitive_action import PrimitiveKind, primitives_of
from pack_core.blocks.problem import BlockSize, PlacedBlock, Problem
from pack_core.errors import PackError
from pack_evaluation.blocks.plan_verifier import verify
from pack_planner.rearrangement.beam.beam_planner import BeamPlanner
from pack_planner.rearrangement.instances import make_instance
from pack_planner.rearrangement.methods import METHODS, RearrangementConfig
from pack_planner.rearrangement.planning import plan

Clocks = Callable[[], Callable[[], float]]
SHORT = RearrangementConfig(beam=BeamPlanner(rounds=4))
SIDE = 50.8


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize(("n", "density", "symmetry"), [(4, 0.2, 1), (9, 0.2, 1), (9, 0.2, 4), (12, 0.08, 2)])
@pytest.mark.parametrize("seed", [1, 2])
def test_plans_are_valid(method: str, n: int, density: float, symmetry: int, seed: int) -> None:
    problem = make_instance(n, density, seed, symmetry=symmetry)
    made = plan(problem, method=method, budget_s=20.0, seed=seed, config=SHORT)
    assert made.is_solved
    assert verify(problem, made) == []
    assert len(made.actions) >= made.lower_bound


@pytest.mark.parametrize("seed", range(3))
def test_nine_blocks_with_room_take_eleven_actions_which_is_proven_optimal(seed: int) -> None:
    made = plan(make_instance(9, 0.08, seed), budget_s=20.0)
    assert made.status is PlanStatus.OPTIMAL
    assert len(made.actions) == made.lower_bound == 11
    assert sum(isinstance(action, Push) for action in made.actions) == 2


@pytest.mark.parametrize("method", METHODS)
def test_the_same_seed_gives_the_same_plan(method: str, clock: Clocks) -> None:
    problem = make_instance(6, 0.2, 5)
    first, second = (
        plan(problem, method=method, budget_s=20.0, seed=7, config=SHORT, clock=clock()) for _ in range(2)
    )
    assert first.is_solved
    assert first.actions == second.actions


@pytest.mark.parametrize("seed", range(3))
def test_a_plan_leads_around_what_has_no_goal(seed: int) -> None:
    """One block of the instance is to stay where it is, beside the goals of the others."""
    problem = make_instance(6, 0.2, seed)
    first, *others = problem.blocks
    goals = {block.id: problem.goals[block.id] for block in others}
    near = problem.goals[first.id].moved(0.012, 0.0)
    beside = Problem((PlacedBlock("tag 7", near), *others), goals, problem.workspace)
    made = plan(beside, budget_s=20.0, seed=seed, config=SHORT)
    assert made.status is not PlanStatus.INVALID_INPUT or "tag 7" in made.diagnosis.text
    assert made.is_solved == (verify(beside, made) == [])
    assert "tag 7" not in {action.block for action in made.actions}


def test_blocks_that_are_home_need_no_plan(make) -> None:
    goals = {"a": (0, 0), "b": (52.8, 0)}
    for starts in (goals, {"a": (0, 1.5, 0.03), "b": (54, 0)}, {}):
        made = plan(make(starts, {name: goals[name] for name in starts}))
        assert made.status is PlanStatus.OPTIMAL
        assert made.actions == ()


def test_a_block_three_millimetres_off_is_brought_home(make) -> None:
    problem = make({"a": (0, 3.5, 0.1)}, {"a": (0, 0)})
    made = plan(problem)
    assert len(made.actions) == 1
    assert verify(problem, made) == []


def test_a_block_that_waits_on_its_push_line_as_measured_is_pushed(make) -> None:
    """As after staging: half a millimetre and a degree off, with neighbours on two sides."""
    home = {"b": (52.8, 0), "c": (0, 52.8), "d": (52.8, 52.8)}
    problem = make({"a": (-21.2, 0.5, 0.017), **home}, {"a": (0, 0), **home})
    made = plan(problem)
    assert [type(action) for action in made.actions] == [Push]
    assert made.status is PlanStatus.OPTIMAL
    assert verify(problem, made) == []


def test_a_blocked_hole_is_opened_by_moving_blocks_that_are_home(make) -> None:
    """The middle of a row of three between two others cannot be entered: one of them makes way."""
    cells = {name: ((SIDE + 2) * (i % 3), (SIDE + 2) * (i // 3)) for i, name in enumerate("abcdefghi")}
    starts = cells | {"e": (250, 250)}
    starts |= {"b": (52.8, -60)}
    problem = make(starts, cells, size=0.7)
    made = plan(problem, budget_s=20.0, config=SHORT)
    assert made.is_solved
    assert verify(problem, made) == []


def test_without_room_to_swap_nothing_is_claimed(make) -> None:
    problem = make({"a": (-26.4, 0), "b": (26.4, 0)}, {"a": (26.4, 0), "b": (-26.4, 0)}, size=0.11)
    made = plan(problem, budget_s=0.2)
    assert made.status is PlanStatus.TIMEOUT
    assert "not proven" in made.diagnosis.text


def test_replanning_from_any_state_of_a_plan_takes_no_more_actions() -> None:
    problem = make_instance(6, 0.08, 2)
    made = plan(problem, budget_s=20.0, config=SHORT)
    for done, poses in enumerate(made.states(problem.starts)):
        now = replace(problem, blocks=tuple(PlacedBlock(name, pose) for name, pose in poses.items()))
        again = plan(now, budget_s=20.0, config=SHORT)
        assert again.is_solved
        assert len(again.actions) <= len(made.actions) - done


def test_cubes_that_may_be_turned_by_quarters_are_turned_by_an_eighth_at_most() -> None:
    made = plan(make_instance(9, 0.08, 3, symmetry=4), budget_s=20.0, config=SHORT)
    turns = [abs(a.place_yaw - a.pick_yaw) for a in made.actions if isinstance(a, PickPlace)]
    assert np.mean([(turn + np.pi / 2) % np.pi - np.pi / 2 for turn in turns]) < np.pi / 4 + 1e-6


def test_blocks_that_bar_each_others_grasps_are_pushed_out(make) -> None:
    """Four blocks like a pinwheel: none can be grasped before one has been pushed along its neighbour."""
    starts = {"a": (16.9, 51.9), "b": (-51.9, 16.9), "c": (-16.9, -51.9), "d": (51.9, -16.9)}
    goals = {name: (60 * i - 100, -200) for i, name in enumerate("abcd")}
    problem = make(starts, goals)
    made = plan(problem, budget_s=20.0, config=SHORT)
    assert made.is_solved
    assert isinstance(made.actions[0], Push)
    assert verify(problem, made) == []


@pytest.mark.parametrize(("yaw", "symmetry"), [(np.pi / 2, 1), (np.pi / 2, 2), (np.pi, 1), (np.pi / 2, 4)])
def test_blocks_pushed_out_lying_across_their_goals_end_as_these_ask(yaw: float, symmetry: int, make) -> None:
    """A push turns no block, so that one pushed out still has the yaw of its start."""
    starts = {"a": (16.9, 51.9), "b": (-51.9, 16.9), "c": (-16.9, -51.9), "d": (51.9, -16.9)}
    turned = {name: (*place, yaw) for name, place in starts.items()}
    goals = {name: (60 * i - 100, -200) for i, name in enumerate("abcd")}
    problem = make(turned, goals, symmetry=symmetry)
    made = plan(problem, budget_s=20.0, config=SHORT)
    assert isinstance(made.actions[0], Push)
    assert verify(problem, made) == []


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize(("yaw", "symmetry"), [(0.5, 1), (np.pi / 2, 1), (np.pi, 1), (0.5, 4)])
def test_a_block_at_its_goal_is_turned_on_the_spot(method: str, yaw: float, symmetry: int, make) -> None:
    problem = make({"a": (0, 0, yaw)}, {"a": (0, 0)}, symmetry=symmetry)
    made = plan(problem, method=method, budget_s=20.0, config=SHORT)
    assert len(made.actions) == 1
    assert verify(problem, made) == []


def test_interlocked_blocks_are_parted_before_the_grid_bars_its_way() -> None:
    """Three blocks beside the grid hold each other; with the grid's near side filled none can be pushed."""
    problem = make_instance(25, 0.2, 74)
    made = plan(problem, budget_s=20.0, config=RearrangementConfig(beam=BeamPlanner(rounds=2)))
    assert made.is_solved
    assert verify(problem, made) == []


@pytest.mark.parametrize("seed", [1, 2])
def test_plans_do_without_what_the_arm_refused(seed: int) -> None:
    problem = make_instance(4, 0.2, seed)
    made = plan(problem, budget_s=20.0, config=SHORT)
    primitives = [primitive for action in made.actions for primitive in primitives_of(action)]
    assert {primitive.kind for primitive in primitives} == set(PrimitiveKind)
    for primitive in primitives:
        without = replace(problem, refused=(primitive,))
        again = plan(without, budget_s=20.0, config=SHORT)
        assert again.is_solved
        assert verify(without, again) == []
        assert any("refused" in fault for fault in verify(without, made))


@pytest.mark.parametrize("yaw", [0.3, np.pi / 2, np.pi])
def test_a_block_that_the_arm_cannot_grasp_is_pushed_out(yaw: float, make) -> None:
    """Towards its goal, into which it may be pushed on only with the goal's yaw."""
    start = PlanarPose(0.0, 0.0, yaw)
    problem = make({"a": start.row}, {"a": (100, 0)})
    ways = [PickPlace("a", start, problem.goals["a"], grasp) for grasp in (0, 1)]
    without = replace(problem, refused=tuple(primitives_of(way)[0] for way in ways))
    made = plan(without, budget_s=20.0, config=SHORT)
    assert isinstance(made.actions[0], Push)
    assert verify(without, made) == []


def test_pirs_draws_again_what_the_arm_refused() -> None:
    problem = make_instance(4, 0.2, 1)
    made = plan(problem, method="pirs", budget_s=20.0)
    push = next(action for action in made.actions if isinstance(action, Push))
    without = replace(problem, refused=primitives_of(push))
    again = plan(without, method="pirs", budget_s=20.0)
    assert again.is_solved
    assert verify(without, again) == []


@pytest.mark.parametrize("seed", [18, 28])
def test_crowded_blocks_are_rearranged(seed: int) -> None:
    """Three tenths of the area: some blocks cannot be grasped before they are pushed out by a little."""
    problem = make_instance(9, 0.3, seed)
    made = plan(problem, budget_s=60.0, seed=seed, config=SHORT)
    assert made.status is PlanStatus.FEASIBLE
    assert verify(problem, made) == []


@pytest.mark.parametrize(
    ("fields", "part"), [({"method": "magic"}, "allowed: beam, pirs"), ({"budget_s": 0.0}, "above 0")]
)
def test_misuse_is_refused_in_words(make, fields: dict[str, object], part: str) -> None:
    with pytest.raises(PackError, match=part):
        plan(make({"a": (0, 0)}), **fields)


def test_plans_do_not_depend_on_where_the_cell_stands() -> None:
    near, far = (make_instance(6, 0.2, 1, centre=centre) for centre in ((0.0, 0.0), (0.65, 0.1)))
    lengths = {len(plan(p, budget_s=20.0, seed=1, config=SHORT).actions) for p in (near, far)}
    assert max(lengths) - min(lengths) <= 1


def test_a_state_lists_every_block_after_every_action() -> None:
    problem: Problem = make_instance(4, 0.2, 1)
    made = plan(problem, budget_s=5.0, config=SHORT)
    states = list(made.states(problem.starts))
    assert len(states) == len(made.actions) + 1
    for state, action in zip(states[1:], made.actions, strict=True):
        assert state[action.block] == action.end
    assert isinstance(states[0]["b1"], PlanarPose)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize(("n", "seed"), [(4, 1001), (6, 1000)])
def test_plans_of_mixed_cuboids_are_valid(method: str, n: int, seed: int) -> None:
    problem = make_instance(n, 0.15, seed, mixed=True)
    assert len(set(problem.sizes.values())) > 1
    made = plan(problem, method=method, budget_s=60.0, seed=seed, config=SHORT)
    assert made.is_solved
    assert verify(problem, made) == []
    assert len(made.actions) >= made.lower_bound


@pytest.mark.parametrize("method", METHODS)
def test_an_oblong_block_ends_lengthwise_as_its_goal_asks(method: str, make) -> None:
    problem = make(
        {"a": (0, 0, 1.4)}, {"a": (150, 100, 0.2)}, sizes={"a": BlockSize(0.04, 0.07, 0.05)}, symmetry=2
    )
    made = plan(problem, method=method, budget_s=60.0)
    assert verify(problem, made) == []
    turn = made.actions[-1].end.yaw - 0.2
    assert abs((turn + np.pi / 2) % np.pi - np.pi / 2) < 1e-6
