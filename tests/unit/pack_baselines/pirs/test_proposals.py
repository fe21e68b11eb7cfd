"""The three proposals of Section V as options: plans stay valid, and each buys what it should."""

import numpy as np
import pytest

from pack_baselines.pirs.pirs_planner import Costs, PirsPlanner
from pack_core.blocks.plan import Plan, Push
from pack_evaluation.blocks.plan_verifier import verify
from pack_planner.rearrangement.instances import make_instance
from pack_planner.rearrangement.methods import RearrangementConfig
from pack_planner.rearrangement.planning import plan

SEEDS = range(1000, 1012)
VERIFIED = SEEDS[:4]
"""Whose plans are verified, which takes three times as long as planning."""
GOALS = [make_instance(9, 0.2, seed).goals for seed in SEEDS]


def plans(planner: PirsPlanner) -> list[Plan]:
    config = RearrangementConfig(pirs=planner)
    found = []
    for seed in SEEDS:
        problem = make_instance(9, 0.2, seed)
        found.append(plan(problem, method="pirs", budget_s=60.0, seed=seed, config=config))
        assert found[-1].is_solved
        if seed in VERIFIED:
            assert verify(problem, found[-1]) == []
    return found


@pytest.fixture(scope="module")
def of_the_paper(compiled: None) -> list[Plan]:
    return plans(PirsPlanner())


def test_a_price_of_distance_shortens_the_way(of_the_paper: list[Plan]) -> None:
    near = plans(PirsPlanner(costs=Costs(distance=2.0)))
    assert np.mean([p.travel() for p in near]) < np.mean([p.travel() for p in of_the_paper])


def test_a_price_of_pushes_lengths_shortens_the_pushes(of_the_paper: list[Plan]) -> None:
    short = plans(PirsPlanner(costs=Costs(push_length=5.0)))
    assert mean_push(short) < mean_push(of_the_paper)


def test_blocks_that_make_way_to_their_goals_are_brought_elsewhere_less_often(
    of_the_paper: list[Plan],
) -> None:
    homing = plans(PirsPlanner(clear_to_goal=True))
    cleared, before = (
        sum(p.cleared(goals) for p, goals in zip(found, GOALS, strict=True))
        for found in (homing, of_the_paper)
    )
    assert cleared < before


def mean_push(found: list[Plan]) -> float:
    return float(np.mean([a.distance for p in found for a in p.actions if isinstance(a, Push)]))
