"""The rearrangement planner's service: plans, proofs, refusals."""

import math
from dataclasses import replace

import pytest
from geometry_msgs.msg import Point
from pack_interfaces.msg import BlockPose, PrimitiveAction
from pack_interfaces.srv import PlanRearrangement

from integration.harness import Graph
from pack_core.blocks.plan import PlanStatus
from pack_core.blocks.primitive_action import primitives_of
from pack_core.blocks.problem import Problem
from pack_core.ros.contracts import blocks as contracts
from pack_core.ros.messages.blocks import from_response, to_request
from pack_evaluation.blocks.plan_verifier import verify
from pack_planner.rearrangement.instances import make_instance
from pack_planner.rearrangement.rearrangement_node import RearrangementNode

Request, Response = PlanRearrangement.Request, PlanRearrangement.Response


@pytest.fixture
def node(graph: Graph) -> RearrangementNode:
    return graph.start(RearrangementNode, **{"beam.rounds": 3})


@pytest.fixture
def problem() -> Problem:
    return make_instance(6, 0.1, 1, symmetry=4, centre=(0.65, 0.0))


def call(graph: Graph, request: Request) -> Response:
    return graph.call(contracts.PLAN_REARRANGEMENT, request)


@pytest.mark.parametrize("method", ["", "beam", "pirs"])
def test_a_plan_comes_back_as_it_was_made(
    graph: Graph, node: RearrangementNode, problem: Problem, method: str
) -> None:
    response = call(graph, to_request(problem, method=method, budget_s=20.0, seed=3))
    made = from_response(response)
    assert made.is_solved, made.diagnosis.text
    assert verify(problem, made) == []
    assert len(made.actions) >= made.lower_bound == 7
    assert 0.0 < response.first_plan_time <= response.planning_time


def test_the_same_request_gets_the_same_answer(
    graph: Graph, node: RearrangementNode, problem: Problem
) -> None:
    first, second = (call(graph, to_request(problem, budget_s=20.0, seed=5)) for _ in range(2))
    assert first.actions == second.actions


def test_a_plan_does_without_what_the_arm_refused(
    graph: Graph, node: RearrangementNode, problem: Problem
) -> None:
    first = from_response(call(graph, to_request(problem, budget_s=20.0)))
    without = replace(problem, refused=primitives_of(first.actions[0]))
    again = from_response(call(graph, to_request(without, budget_s=20.0)))
    assert verify(without, first) != []
    assert again.is_solved
    assert verify(without, again) == []


def test_an_impossible_problem_is_answered_with_the_blocks_that_are_stuck(
    graph: Graph, node: RearrangementNode, problem: Problem
) -> None:
    grid = problem.goals
    request = to_request(problem)
    names = sorted(grid)
    request.blocks = [
        BlockPose(id=name, x=grid[other].x, y=grid[other].y)
        for name, other in zip(names, names[1:] + names[:1], strict=True)
    ]
    response = call(graph, request)
    assert response.status == Response.INFEASIBLE
    assert list(response.blocks) == names
    assert math.isnan(response.first_plan_time)


def test_bad_requests_are_refused_in_words_and_the_next_one_is_served(
    graph: Graph, node: RearrangementNode, problem: Problem
) -> None:
    broken, doubled, unknown, gripper, corners, primitive = (to_request(problem) for _ in range(6))
    broken.blocks[0].x = math.nan
    doubled.goals = [*doubled.goals, doubled.goals[0]]
    unknown.method = "magic"
    gripper.gripper.insertion = -1.0
    corners.workspace = [Point()]
    primitive.refused = [PrimitiveAction(kind=7)]
    parts = [
        "is not finite",
        "more than once in the goals",
        "beam, pirs",
        "gripper: key 'insertion'",
        "convex",
        "refused primitive action is of kind 7",
    ]
    for request, part in zip((broken, doubled, unknown, gripper, corners, primitive), parts, strict=True):
        response = call(graph, request)
        assert response.status == Response.INVALID_INPUT
        assert part in response.message
    assert from_response(call(graph, to_request(problem))).status is not PlanStatus.INVALID_INPUT
