"""The planner's service: placements, refusals, and markers for a viewer."""

import math

import pytest
from geometry_msgs.msg import Point
from pack_interfaces.msg import SceneState as SceneStateMsg
from pack_interfaces.srv import PlanPlacement
from std_msgs.msg import String
from visualization_msgs.msg import Marker

from integration.harness import Graph
from pack_core.packing.scene import Scene
from pack_core.packing.scene_file import load_scene
from pack_core.paths import config_path
from pack_core.ros.contracts import packing as contracts
from pack_core.ros.messages.conversions import from_pose
from pack_core.ros.messages.scene import to_scene
from pack_core.rotations import Pose
from pack_core.states import ObjectState, SceneState
from pack_planner.placement.planner_node import PlannerNode
from pack_planner.placement.ros.placement_markers import SETTLED

Response = PlanPlacement.Response
SAMPLES = 40


@pytest.fixture
def scene() -> Scene:
    return load_scene(config_path("scenarios", "packing", "example.yaml"))


@pytest.fixture
def planner(graph: Graph, scene: Scene) -> PlannerNode:
    """A planner that has heard the description of the example."""
    node = graph.start(PlannerNode, samples=SAMPLES)
    describe(graph, scene.description().to_yaml())
    graph.wait_until(lambda: not node.waits_for)
    return node


def describe(graph: Graph, text: str) -> None:
    graph.connect(contracts.DESCRIPTION)
    graph.probe.send(contracts.DESCRIPTION, String(data=text))


def message_of(scene: Scene) -> SceneStateMsg:
    poses = scene.poses() | {scene.new_object.name: Pose([0.5, 0.0, 0.5])}
    return to_scene(SceneState(1.5, {name: ObjectState(X_WO) for name, X_WO in poses.items()}))


def plan(graph: Graph, scene: SceneStateMsg, **fields: object) -> Response:
    request = PlanPlacement.Request(scene=scene, seed=3, **fields)
    return graph.call(contracts.PLAN_PLACEMENT, request, timeout=90.0)  # rehearsing takes a busy machine long


def test_a_placement_comes_with_collisions_cost_and_all_samples(
    graph: Graph, planner: PlannerNode, scene: Scene
) -> None:
    response = plan(graph, message_of(scene))
    assert response.status == Response.SUCCESS, response.message
    assert set(response.collisions) <= set(scene.names)
    assert response.collisions
    assert response.cost == min(sample.cost for sample in response.samples if sample.is_feasible)
    assert len(response.samples) == SAMPLES
    assert response.planning_time > 0.0
    assert from_pose(response.pose).p[2] == pytest.approx(0.09, abs=0.005)


def test_the_same_request_gets_the_same_answer(graph: Graph, planner: PlannerNode, scene: Scene) -> None:
    first, second = (plan(graph, message_of(scene)) for _ in range(2))
    assert first.pose == second.pose
    assert first.samples == second.samples


def test_points_to_avoid_are_avoided(graph: Graph, planner: PlannerNode, scene: Scene) -> None:
    first = plan(graph, message_of(scene)).pose.position
    second = plan(graph, message_of(scene), avoid=[first], avoid_radius=0.03).pose.position
    assert math.hypot(first.x - second.x, first.y - second.y) >= 0.03


def test_after_a_failure_the_answer_is_rehearsed_and_says_where_to_lean(
    graph: Graph, planner: PlannerNode, scene: Scene
) -> None:
    failed = plan(graph, message_of(scene)).pose.position
    response = plan(graph, message_of(scene), avoid=[failed], avoid_radius=0.02, lean=0.6)
    assert response.status == Response.SUCCESS
    assert response.collisions
    assert math.hypot(response.over.x, response.over.y) == pytest.approx(1.0)
    assert response.lean >= 0.6


def test_the_random_variant_is_served(graph: Graph, planner: PlannerNode, scene: Scene) -> None:
    response = plan(graph, message_of(scene), variant="random")
    assert response.status == Response.SUCCESS
    assert len(response.samples) == 1


def test_samples_and_the_chosen_pose_are_drawn(graph: Graph, planner: PlannerNode, scene: Scene) -> None:
    graph.probe.listen(contracts.VISUAL_MARKERS)
    response = plan(graph, message_of(scene))
    graph.wait_until(lambda: graph.probe.last(contracts.VISUAL_MARKERS))
    samples, chosen, *settled = graph.probe.last(contracts.VISUAL_MARKERS).markers
    assert [marker.ns for marker in settled] == [SETTLED] * (len(scene.names) + 2)
    assert len(samples.points) == len(samples.colors) == SAMPLES
    assert chosen.type == Marker.CUBE
    assert chosen.pose == response.pose
    assert chosen.header.frame_id == "world"


def test_without_a_description_the_answer_says_what_to_start(graph: Graph, scene: Scene) -> None:
    graph.start(PlannerNode)
    response = plan(graph, message_of(scene))
    assert response.status == Response.INVALID_INPUT
    assert "/cell_description" in response.message
    assert "start the sim" in response.message


def test_a_description_that_cannot_be_packed_is_reported(graph: Graph, scene: Scene) -> None:
    node = graph.start(PlannerNode)
    giant = scene.new_object.model_copy(update={"size": (0.3, 0.3, 0.1)})
    describe(graph, scene.description().model_copy(update={"new_object": giant}).to_yaml())
    graph.wait_until(lambda: node.health.counts["refused /cell_description"])
    response = plan(graph, message_of(scene))
    assert response.status == Response.INVALID_INPUT
    assert "0.300 x 0.300 m wide" in response.message


def test_bad_requests_are_refused_in_words_and_the_next_one_is_served(
    graph: Graph, planner: PlannerNode, scene: Scene
) -> None:
    good, broken, incomplete = (message_of(scene) for _ in range(3))
    broken.objects[0].pose.position.x = math.nan
    incomplete.objects = incomplete.objects[1:]
    refusals = [
        plan(graph, broken),
        plan(graph, incomplete),
        plan(graph, good, variant="magic"),
        plan(graph, good, avoid=[Point(x=math.inf)]),
        plan(graph, good, avoid_radius=-1.0),
        plan(graph, good, lean=2.0),
    ]
    assert [response.status for response in refusals] == [Response.INVALID_INPUT] * len(refusals)
    for response, part in zip(
        refusals,
        [
            "not finite",
            "soup_can",
            "algorithm_1, algorithm_1_literal, random",
            "not finite",
            "avoid_radius",
            "lean is 2.0",
        ],
        strict=True,
    ):
        assert part in response.message
    assert planner.health.counts["refused /plan_placement"] == len(refusals)
    assert plan(graph, good).status == Response.SUCCESS
