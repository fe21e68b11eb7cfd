"""The simulator, tag perception and executor of the blocks cell as nodes."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from pack_interfaces.action import Rearrange
from pack_interfaces.srv import JawCommand
from std_srvs.srv import Trigger

from block_fsm.block_fsm_node import BlockFsmNode
from integration.harness import Graph
from pack_core.blocks.gripper import FingerStatus
from pack_core.blocks.planar import PlanarPose
from pack_core.blocks.problem import PlacedBlock, Problem
from pack_core.blocks.problem_file import problem_text
from pack_core.errors import PackError
from pack_core.ros.contracts import blocks as contracts
from pack_core.ros.contracts import motion, shared
from pack_core.ros.messages.blocks import from_sighting
from pack_perception.tags.tag_perception_node import TagPerceptionNode
from pack_sim.blocks.blocks_sim_node import BlocksSimNode
from pack_sim.blocks.overhead_camera import OverheadCamera

STARTS = {"a": PlanarPose(0.58, -0.05, 0.4), "b": PlanarPose(0.7, 0.06, -1.1)}
GOALS = {"a": PlanarPose(0.62, 0.05, 0.0), "b": PlanarPose(0.6728, 0.05, 0.0)}
SQUARE = ((0.5, -0.15), (0.8, -0.15), (0.8, 0.15), (0.5, 0.15))
TEXT = problem_text(Problem(tuple(PlacedBlock(name, pose) for name, pose in STARTS.items()), GOALS, SQUARE))


@pytest.fixture
def graph() -> Iterator[Graph]:
    opened = Graph()
    yield opened
    opened.close()


def start_sim(
    graph: Graph, tmp_path: Path, factor: float, make: type[BlocksSimNode] = BlocksSimNode
) -> BlocksSimNode:
    file = tmp_path / "problem.yaml"
    file.write_text(TEXT)
    node = graph.start(make, problem=str(file), real_time_factor=factor)
    sensors = (shared.CLOCK, motion.JOINT_STATES, contracts.JAW_STATE, contracts.TRUTH)
    graph.probe.listen(*sensors, contracts.BLOCK_POSES)
    graph.wait_until(lambda: all(graph.probe.last(contract) for contract in sensors))
    return node


def test_a_picture_on_request_tells_where_the_blocks_are(graph: Graph, tmp_path: Path) -> None:
    start_sim(graph, tmp_path, factor=0.3)
    graph.start(TagPerceptionNode)
    graph.wait_until(lambda: graph.probe.count_publishers(contracts.BLOCK_POSES.name))
    assert graph.call(contracts.TRIGGER, Trigger.Request()).success
    graph.wait_until(lambda: graph.probe.last(contracts.BLOCK_POSES), timeout=60.0)
    sighting = from_sighting(graph.probe.last(contracts.BLOCK_POSES))
    assert sighting.is_complete
    for name, pose in STARTS.items():
        assert sighting.poses[name].distance_to(pose) < 0.3e-3


def test_a_camera_that_cannot_draw_says_why_to_whoever_asks(
    graph: Graph, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(_: OverheadCamera) -> OverheadCamera:
        raise PackError("cannot draw without a screen")

    monkeypatch.setattr(OverheadCamera, "__enter__", refuse)
    node = start_sim(graph, tmp_path, factor=0.3)
    graph.wait_until(lambda: "camera" in node.health.faults)
    answer = graph.call(contracts.TRIGGER, Trigger.Request())
    assert not answer.success
    assert answer.message == "cannot draw without a screen"


def test_fingers_obey_and_refuse_what_they_cannot_do(graph: Graph, tmp_path: Path) -> None:
    start_sim(graph, tmp_path, factor=0.5)
    answer = graph.call(contracts.JAW_COMMAND, JawCommand.Request(opening=0.02, force=40.0))
    assert answer.success
    graph.wait_until(
        lambda: (
            graph.probe.last(contracts.JAW_STATE).command == answer.command
            and graph.probe.last(contracts.JAW_STATE).status == FingerStatus.AT_OPENING
        ),
        timeout=60.0,
    )
    assert graph.probe.last(contracts.JAW_STATE).opening == pytest.approx(0.02, abs=0.001)
    refused = graph.call(contracts.JAW_COMMAND, JawCommand.Request(opening=0.2, force=40.0))
    assert not refused.success
    assert "allowed" in refused.message


def test_a_goal_that_cannot_be_read_is_refused(graph: Graph) -> None:
    graph.start(BlockFsmNode)
    assert "blocks" in graph.refusal(contracts.REARRANGE, Rearrange.Goal(problem="blocks: none"))
    assert "`problem` is empty" in graph.refusal(contracts.REARRANGE, Rearrange.Goal())
