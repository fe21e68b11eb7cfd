"""The rearrangement planner on a request that it has answered, told by events as the node tells them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from pack_interfaces.srv import PlanRearrangement

from pack_core.blocks.plan import Plan, PlanStatus
from pack_core.blocks.planar import PlanarPose
from pack_core.blocks.problem import Problem
from pack_core.blocks.topics import REARRANGEMENT_EVENTS
from pack_core.ros.messages.blocks import fill_plan, to_request
from pack_evaluation.bag import Bag, Recorded
from pack_lockstep.blocks.replay import replay_rearrangement
from pack_lockstep.node_parameters import load_parameters
from pack_lockstep.replay import RECEIVED, SENT, RunConditions
from pack_planner.rearrangement.instances import make_instance
from pack_planner.rearrangement.methods import PlanningConfig
from pack_planner.rearrangement.planning import plan

SEED = 3
pytestmark = pytest.mark.usefixtures("compiled")


@pytest.fixture(scope="module")
def problem() -> Problem:
    return make_instance(9, 0.2, SEED)


@pytest.fixture(scope="module")
def answer(problem: Problem) -> Plan:
    """The planner's first plan, as of a node that had no time for a second."""
    config = load_parameters("blocks/rearrangement", PlanningConfig)
    return plan(problem, budget_s=60.0, seed=SEED, config=config, is_enough=lambda _: True)


def recording(problem: Problem, answer: Plan, budget_s: float = 1.0) -> Bag:
    asked = PlanRearrangement.Event(
        request=[to_request(problem, method="beam", budget_s=budget_s, seed=SEED)]
    )
    told = PlanRearrangement.Event(response=[PlanRearrangement.Response()])
    fill_plan(told.response[0], answer)
    asked.info.event_type, told.info.event_type = RECEIVED, SENT
    events = (Recorded(REARRANGEMENT_EVENTS, time, event) for time, event in enumerate((asked, told)))
    return Bag(Path("bag"), tuple(events), is_cut=False)


def test_the_planner_comes_to_the_plan_that_was_answered(problem: Problem, answer: Plan) -> None:
    """Also where it would find a shorter one, had it more time."""
    assert answer.is_solved
    found = replay_rearrangement(recording(problem, answer), RunConditions())
    assert found.inputs == {REARRANGEMENT_EVENTS: 1}
    assert found.agrees, found.rows


def test_a_plan_that_the_planner_does_not_find_is_noticed(problem: Problem, answer: Plan) -> None:
    first, *rest = answer.actions
    aside = replace(first, end=PlanarPose(first.end.x + 1e-3, first.end.y, first.end.yaw))
    other = replace(answer, actions=(aside, *rest), status=PlanStatus.OPTIMAL)
    assert not replay_rearrangement(recording(problem, other, budget_s=0.1), RunConditions()).agrees


def test_an_answer_without_a_plan_is_compared_by_its_status(problem: Problem) -> None:
    twice = replace(problem, blocks=(*problem.blocks, problem.blocks[0]))
    refused = plan(twice)
    assert refused.status is PlanStatus.INVALID_INPUT
    assert replay_rearrangement(recording(twice, refused), RunConditions()).agrees
    claimed = replace(refused, status=PlanStatus.INFEASIBLE)
    assert not replay_rearrangement(recording(twice, claimed), RunConditions()).agrees
