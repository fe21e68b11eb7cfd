"""The price of a plan as in the paper: Eq. 1 for every action, and more for a long push (Section V)."""

from collections.abc import Callable

import numpy as np
import pytest

from pack_core.blocks.plan import Plan, Push
from pack_core.config import parse_config
from pack_core.errors import ConfigError
from pack_evaluation.blocks.plan_verifier import verify
from pack_planner.rearrangement.beam.beam_planner import BeamPlanner, PlanCosts
from pack_planner.rearrangement.beam.tables import FREE
from pack_planner.rearrangement.instances import make_instance
from pack_planner.rearrangement.methods import RearrangementConfig
from pack_planner.rearrangement.planning import plan

ROUNDS = 7
COSTS = PlanCosts()
Clocks = Callable[[], Callable[[], float]]


def made(planner: BeamPlanner, seed: int, clock: Clocks, blocks: int = 6) -> Plan:
    config = RearrangementConfig(beam=planner)
    return plan(make_instance(blocks, 0.2, seed), budget_s=20.0, seed=seed, config=config, clock=clock())


def cost(found: Plan, costs: PlanCosts = COSTS) -> float:
    """alpha_1 for every pick-and-place action, alpha_2 and the price of its length for every push."""
    pushes = [action.distance for action in found.actions if isinstance(action, Push)]
    carried = len(found.actions) - len(pushes)
    return costs.pick_place * carried + costs.push * len(pushes) + costs.push_length * sum(pushes)


def test_the_premium_of_a_push_is_what_it_costs_beyond_a_pick_and_place_action() -> None:
    price = PlanCosts(pick_place=2.0, push=3.0, push_length=8.0).push_price
    assert price.premium(0.05) == pytest.approx((3.0 + 8.0 * 0.05) / 2.0 - 1.0)


def test_by_default_a_push_costs_an_action() -> None:
    assert BeamPlanner().push_price == FREE
    assert FREE.premium(0.1) == 0.0


def test_plans_cost_no_more_in_all_than_those_with_the_fewest_actions(clock: Clocks) -> None:
    """One by one they may: the search does not find all plans."""
    sums = {"actions": 0.0, "paper": 0.0}
    for price in sums:
        for seed in range(5):
            found = made(BeamPlanner(price=price, rounds=ROUNDS), seed, clock)
            assert found.is_solved
            if price == "paper":
                assert verify(make_instance(6, 0.2, seed), found) == []
            assert len(found.actions) >= found.lower_bound
            sums[price] += cost(found)
    assert sums["paper"] < sums["actions"]


def test_dear_lengths_make_pushes_short(clock: Clocks) -> None:
    def lengths(planner: BeamPlanner) -> list[float]:
        plans = [made(planner, seed, clock, blocks=4) for seed in range(6)]
        return [action.distance for p in plans for action in p.actions if isinstance(action, Push)]

    usual = lengths(BeamPlanner(rounds=ROUNDS))
    short = lengths(BeamPlanner(price="paper", rounds=ROUNDS, costs=PlanCosts(push_length=20.0)))
    assert np.mean(short) < np.mean(usual)


def test_with_equal_prices_the_paper_counts_actions(clock: Clocks) -> None:
    equal = BeamPlanner(price="paper", rounds=3, costs=PlanCosts(push=1.0, push_length=0.0))
    first, second = made(equal, 1, clock), made(BeamPlanner(rounds=3), 1, clock)
    assert first.actions == second.actions


def test_a_push_must_not_be_cheaper_than_a_pick_and_place_action() -> None:
    """The bounds of the search count a push as one action at least."""
    with pytest.raises(ConfigError, match=r"push is 0\.5; allowed: pick_place, 1, or more"):
        parse_config(BeamPlanner, "costs: {push: 0.5}", "test")
