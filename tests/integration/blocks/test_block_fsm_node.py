"""The blocks executor as a node, with a probe that plays the rest of the cell."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from pack_interfaces.action import Rearrange
from pack_interfaces.msg import ArmState, PrimitiveAction
from pack_interfaces.msg import BlockSighting as BlockSightingMsg
from pack_interfaces.srv import PlanRearrangement

from block_fsm.block_fsm_node import BlockFsmNode
from integration.blocks.blocks_rig import BlocksRig
from integration.harness import Graph
from pack_core.blocks.gripper import FingerState, FingerStatus
from pack_core.blocks.plan import PickPlace, Plan, PlanStatus
from pack_core.blocks.planar import PlanarPose
from pack_core.blocks.problem import PlacedBlock, Problem
from pack_core.blocks.problem_file import problem_text
from pack_core.motion.target import MotionState
from pack_core.ros.contracts import blocks as contracts
from pack_core.ros.contracts import motion, shared
from pack_core.ros.node import CellNode

GOALS = {"a": PlanarPose(0.62, 0.05, 0.0), "b": PlanarPose(0.6728, 0.05, 0.0)}
AWAY = PlanarPose(0.55, -0.1, 0.4)
SQUARE = ((0.5, -0.15), (0.8, -0.15), (0.8, 0.15), (0.5, 0.15))
TEXT = problem_text(Problem(tuple(PlacedBlock(name, pose) for name, pose in GOALS.items()), GOALS, SQUARE))
QUICK = {"looks": 2, "fault_time": 0.1, "watched": ["tags"]}
PICTURE = 0.4
"""For which a node waits for a picture where none that it can use will come [s]."""
TO_GOAL = Plan(PlanStatus.OPTIMAL, (PickPlace("a", AWAY, GOALS["a"], 0),), 1)


@pytest.fixture
def graph() -> Iterator[Graph]:
    opened = Graph()
    yield opened
    opened.close()


@pytest.fixture
def rig(graph: Graph) -> BlocksRig:
    return BlocksRig(graph, dict(GOALS))


@pytest.fixture
def node(graph: Graph, rig: BlocksRig) -> BlockFsmNode:
    return graph.start(BlockFsmNode, **{"patience.picture": PICTURE, **QUICK})


@pytest.fixture
def patient_node(graph: Graph, rig: BlocksRig) -> BlockFsmNode:
    """A node that waits for a picture, however busy the machine, until it comes or the goal ends."""
    return graph.start(BlockFsmNode, **{"patience.picture": 600.0, **QUICK})


def accepted(graph: Graph) -> Any:
    """The goal, sent when the executor has heard of arm and gripper."""
    graph.wait_until_ready("fsm")
    return graph.send_goal(contracts.REARRANGE, Rearrange.Goal(problem=TEXT))


def outcome(graph: Graph) -> Rearrange.Result:
    return graph.result_of(accepted(graph))


def test_a_picture_is_used_though_the_motion_is_ahead_of_the_clock(
    graph: Graph, patient_node: BlockFsmNode, rig: BlocksRig
) -> None:
    result = outcome(graph)
    assert result.success, result.message
    assert result.exit_reason == "arranged"
    assert result.plans == 1


def test_a_tag_seen_twice_ends_the_goal_with_its_block(
    graph: Graph, patient_node: BlockFsmNode, rig: BlocksRig
) -> None:
    def double(message: BlockSightingMsg) -> None:
        message.blocks, message.doubled = message.blocks[:1], ["b"]

    rig.on_sighting = double
    result = outcome(graph)
    assert (result.success, result.exit_reason) == (False, "not seen")
    assert result.message == "seen more than once: b"


def test_a_camera_that_takes_no_pictures_is_quoted(graph: Graph, node: BlockFsmNode, rig: BlocksRig) -> None:
    rig.camera = "no OpenGL to draw with"
    result = outcome(graph)
    assert result.exit_reason == "not seen"
    assert "no OpenGL to draw with" in result.message


def test_poses_that_are_no_numbers_are_dropped_and_counted(
    graph: Graph, node: BlockFsmNode, rig: BlocksRig
) -> None:
    def spoil(message: BlockSightingMsg) -> None:
        message.blocks[0].x = np.nan

    rig.on_sighting = spoil
    result = outcome(graph)
    assert result.exit_reason == "not seen"
    assert "nothing is told of what is in it" in result.message
    assert node.health.counts["refused /block_poses"] >= 1


def test_one_bad_message_is_outlived(graph: Graph, rig: BlocksRig) -> None:
    graph.start(BlockFsmNode, **{"patience.picture": 4 * PICTURE, **QUICK})  # the next one is waited for, too

    def spoil(message: BlockSightingMsg) -> None:
        message.blocks[0].yaw = np.nan
        rig.on_sighting = lambda _: None

    rig.on_sighting = spoil
    assert outcome(graph).success


def test_a_plan_with_what_is_no_number_is_not_carried_out(
    graph: Graph, patient_node: BlockFsmNode, rig: BlocksRig
) -> None:
    def spoil(response: PlanRearrangement.Response) -> None:
        response.actions[0].end.x = np.nan

    rig.poses, rig.plan, rig.on_plan = {**GOALS, "a": AWAY}, TO_GOAL, spoil
    result = outcome(graph)
    assert result.exit_reason == "no plan"
    assert "the planner's answer cannot be used" in result.message
    assert len(rig.targets) == 1


def test_a_refused_motion_ends_the_goal_with_what_is_in_the_way(
    graph: Graph, patient_node: BlockFsmNode, rig: BlocksRig
) -> None:
    rig.state, rig.reason = MotionState.REFUSED, "'palm' would be 3 mm from 'b' in 'down'"
    result = outcome(graph)
    assert result.exit_reason == "motion failed"
    assert result.message == "REFUSED: 'palm' would be 3 mm from 'b' in 'down'"


def test_an_action_that_is_refused_is_planned_around(
    graph: Graph, patient_node: BlockFsmNode, rig: BlocksRig
) -> None:
    rig.poses, rig.plan, rig.refused = {**GOALS, "a": AWAY}, TO_GOAL, "approach"
    result = outcome(graph)
    assert (result.refusals, result.failed_grasps) == (1, 3)
    first, second, *_ = rig.problems
    assert len(first.refused) == 0
    assert [primitive.kind for primitive in second.refused] == [PrimitiveAction.GRASP]
    assert second.refused[0].x == pytest.approx(AWAY.x)


def test_every_move_is_sent_with_what_stands_around_it(
    graph: Graph, patient_node: BlockFsmNode, rig: BlocksRig
) -> None:
    rig.poses, rig.plan = {**GOALS, "a": AWAY}, TO_GOAL
    result = outcome(graph)
    assert result.failed_grasps == 3
    approach = rig.targets[1]
    assert approach.is_checked
    assert {item.name for item in approach.obstacles} == {"table", "a", "b"}
    assert approach.opening == pytest.approx(0.0588)


def test_a_node_that_dies_ends_the_goal_and_stops_the_arm(
    graph: Graph, patient_node: BlockFsmNode, rig: BlocksRig
) -> None:
    rig.camera = "still busy"
    tags = graph.start(lambda **kwargs: CellNode("tags", **kwargs))
    graph.wait_until(lambda: patient_node.hears("tags"))
    handle = accepted(graph)
    graph.wait_until(lambda: rig.targets)
    graph.stop(tags)
    result = graph.result_of(handle)
    assert (result.success, result.exit_reason) == (False, "node silent")
    assert "'tags'" in result.message
    graph.wait_until(lambda: not rig.targets[-1].segments)


def test_the_goals_of_a_problem_are_shown(graph: Graph, patient_node: BlockFsmNode, rig: BlocksRig) -> None:
    rig.camera = "still busy"
    graph.probe.listen(motion.GOAL_MARKERS)
    accepted(graph)
    graph.wait_until(lambda: graph.probe.last(motion.GOAL_MARKERS))
    _, *markers = graph.probe.last(motion.GOAL_MARKERS).markers
    assert [marker.text for marker in markers[1::2]] == list(GOALS)
    assert markers[0].pose.position.x == pytest.approx(GOALS["a"].x)


def test_a_goal_is_refused_while_the_fingers_hold_something_and_taken_when_they_are_shut(
    graph: Graph, patient_node: BlockFsmNode, rig: BlocksRig
) -> None:
    rig.fingers = FingerState(0.0, 0.05, 40.0, FingerStatus.HOLDING)
    graph.wait_until_ready("fsm")
    assert "hold something 50 mm wide" in graph.refusal(contracts.REARRANGE, Rearrange.Goal(problem=TEXT))
    assert not rig.targets, "nothing moves"
    rig.fingers = FingerState(0.0, 0.0, 40.0, FingerStatus.HOLDING)
    graph.wait_until(lambda: patient_node.refusal(Rearrange.Goal(problem=TEXT)) == "")
    assert outcome(graph).success


def test_a_stop_of_the_arm_ends_the_goal_with_the_reason(
    graph: Graph, patient_node: BlockFsmNode, rig: BlocksRig
) -> None:
    rig.camera = "still busy"
    handle = accepted(graph)
    graph.wait_until(lambda: rig.targets)
    graph.connect(shared.ARM_STATE)
    graph.probe.send(shared.ARM_STATE, ArmState(is_stopped=True, reason="a button", stops=1))
    result = graph.result_of(handle)
    assert (result.success, result.exit_reason) == (False, "arm stopped")
    assert result.message == "the arm was stopped: a button"
    graph.wait_until(lambda: not rig.targets[-1].segments)


def test_a_goal_that_is_cancelled_stops_the_arm(
    graph: Graph, patient_node: BlockFsmNode, rig: BlocksRig
) -> None:
    rig.camera = "still busy"
    handle = accepted(graph)
    graph.wait_until(lambda: rig.targets)
    handle.cancel_goal_async()
    assert graph.result_of(handle).exit_reason == "canceled"
    graph.wait_until(lambda: not rig.targets[-1].segments)
