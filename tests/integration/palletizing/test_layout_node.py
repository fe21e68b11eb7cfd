"""The layout service: plans, refusals in words."""

import json

import pytest
from pack_interfaces.srv import PlanLayout

from integration.harness import Graph
from pack_core.palletizing.orders.layout_plan import LayoutStatus
from pack_core.palletizing.orders.order_file import load_order
from pack_core.paths import config_path
from pack_core.ros.contracts import palletizing as contracts
from pack_core.ros.messages.palletizing import from_layout
from pack_planner.layout.layout_node import LayoutNode
from pack_planner.layout.layout_planner import LayoutConfig, LayoutPlanner

Response = PlanLayout.Response
DENSE = config_path("orders", "order_05.json")


@pytest.fixture
def node(graph: Graph) -> LayoutNode:
    return graph.start(LayoutNode)


def plan(graph: Graph, order: str, gap: float = -1.0) -> Response:
    return graph.call(contracts.PLAN_LAYOUT, PlanLayout.Request(order=order, gap=gap))


def test_the_service_answers_with_the_plan_of_the_core(graph: Graph, node: LayoutNode) -> None:
    response = plan(graph, DENSE.read_text(), 0.005)
    assert response.status == Response.SUCCESS, response.message
    assert response.planning_time > 0.0
    served, own = from_layout(response), LayoutPlanner(LayoutConfig()).plan(load_order(DENSE), 0.005)
    assert (served.status, served.gap, served.virtual_margin) == (own.status, 0.005, own.virtual_margin)
    for a, b in zip(served.boxes, own.boxes, strict=True):
        assert (a.placed.id, a.insertion.direction) == (b.placed.id, b.insertion.direction)
        assert a.placed.lower.tolist() == b.placed.lower.tolist()
        assert a.insertion.outward.tolist() == b.insertion.outward.tolist()


def test_a_negative_gap_asks_for_the_parameter(graph: Graph) -> None:
    graph.start(LayoutNode, **{"separator.gap": 0.004})
    assert plan(graph, DENSE.read_text()).gap == 0.004


def test_a_gap_that_cannot_be_had_is_answered_with_its_reason(graph: Graph) -> None:
    graph.start(LayoutNode, **{"separator.max_margin": 0.0})
    response = plan(graph, DENSE.read_text(), 0.01)
    assert response.status == LayoutStatus.INFEASIBLE
    assert "no gap of 10 mm" in response.message
    assert not response.boxes


def test_bad_orders_are_refused_in_words_and_the_next_one_is_served(graph: Graph, node: LayoutNode) -> None:
    stress = config_path("orders", "stress", "order_01.json").read_text()
    twice = json.loads(DENSE.read_text())
    twice["boxes"][1]["id"] = twice["boxes"][0]["id"]
    for order, words in [
        ("not json", "the order of the request, line 1: is no JSON"),
        ("{}", "key 'order_id' is missing"),
        (json.dumps(twice), "is given 2 times"),
        (stress, "box '00104636-5': 46.2% of its base is carried"),
    ]:
        response = plan(graph, order)
        assert response.status == Response.INVALID_INPUT
        assert words in response.message
    assert plan(graph, DENSE.read_text(), float("inf")).status == Response.INVALID_INPUT
    assert node.health.counts["refused /plan_layout"] == 5
    assert plan(graph, DENSE.read_text()).status == Response.SUCCESS
