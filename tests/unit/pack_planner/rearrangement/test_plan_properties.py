"""Whatever the problem: other code accepts the plan, and nothing on its way is called impossible."""

from dataclasses import replace
from itertools import count

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pack_core.blocks.plan import Plan
from pack_core.blocks.planar import QUARTER, PlanarPose
from pack_core.blocks.problem import PlacedBlock, Problem
from pack_evaluation.blocks.plan_verifier import verify
from pack_planner.rearrangement.beam.beam_planner import BeamPlanner
from pack_planner.rearrangement.certificates import find_certificate
from pack_planner.rearrangement.instances import goal_grid, make_instance
from pack_planner.rearrangement.lower_bound import lower_bound, sharper_bound
from pack_planner.rearrangement.methods import METHODS, RearrangementConfig
from pack_planner.rearrangement.planning import plan
from pack_planner.rearrangement.snapped_problem import SnappedProblem

QUICK = RearrangementConfig(beam=BeamPlanner(widths=(8, 32), rounds=2))
LOOKS = 1000
"""At the clock, before the time is over."""


@st.composite
def problems(draw: st.DrawFn) -> Problem:
    """Blocks scattered around a grid that may be turned, and is more or less dense."""
    n, symmetry = draw(st.integers(1, 8)), draw(st.sampled_from([1, 2, 4]))
    density, seed = draw(st.sampled_from([0.06, 0.12])), draw(st.integers(0, 999))
    scattered = make_instance(n, density, seed, symmetry=symmetry)
    turn, gap = draw(st.sampled_from([0.0, 0.3, 2.5])), draw(st.sampled_from([0.0011, 0.002, 0.012, 0.03]))
    grid = [turned(pose, turn) for pose in goal_grid(n, gap=gap)]
    return replace(
        scattered, goals=dict(zip(draw(st.permutations(list(scattered.goals))), grid, strict=True))
    )


def turned(pose: PlanarPose, turn: float) -> PlanarPose:
    """About the origin."""
    centre = PlanarPose(0.0, 0.0, turn)
    return centre.moved(pose.x, turn).moved(pose.y, turn + QUARTER)


def planned(problem: Problem, method: str, seed: int = 0) -> Plan:
    looks = count()
    return plan(
        problem, method=method, budget_s=LOOKS, seed=seed, config=QUICK, clock=lambda: float(next(looks))
    )


@pytest.mark.parametrize("method", METHODS)
@given(problem=problems())
@settings(max_examples=40)
def test_a_plan_is_accepted_and_everything_on_its_way_is_possible(method: str, problem: Problem) -> None:
    made = planned(problem, method)
    if not made.is_solved:
        return
    assert verify(problem, made) == []
    for done, poses in enumerate(made.states(problem.starts)):
        now = replace(problem, blocks=tuple(PlacedBlock(name, pose) for name, pose in poses.items()))
        snapped = SnappedProblem.of(now)
        assert find_certificate(snapped) is None
        assert sharper_bound(snapped, lower_bound(snapped)) <= len(made.actions) - done


@given(problem=problems(), seed=st.integers(0, 99))
@settings(max_examples=25)
def test_no_method_undercuts_the_bound(problem: Problem, seed: int) -> None:
    plans = [planned(problem, method, seed) for method in METHODS]
    for made in plans:
        if made.is_solved:
            assert len(made.actions) >= max(other.lower_bound for other in plans)
