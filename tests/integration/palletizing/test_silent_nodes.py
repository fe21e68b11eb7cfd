"""A node that dies while the arm moves: the arm brakes at once, and goes on only where that makes sense."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest

from integration.harness import Graph
from integration.palletizing.pallet_rig import newest_joints, start_pallet_sim
from pack_core.motion.moves import Path, PoseMove
from pack_core.motion.target import MotionTarget
from pack_core.ros.contracts import motion
from pack_core.ros.messages.motion import to_target
from pack_core.ros.node import CellNode
from pack_core.rotations import Pose, from_rpy
from pack_motion.motion_node import MotionNode
from pack_sim.palletizing.pallet_sim_node import PalletSimNode

GOAL = Pose(np.array([-2.3, 2.4, 1.3]), from_rpy((np.pi, 0.0, 0.0)))
FAST, STANDING = 0.5, 0.02
"""Speed of the fastest joint [rad/s]."""
BRAKES = 0.1
"""Time after which the arm must have begun to brake [s simulated]."""
OTHERS = ("fsm", "vision")
NUMBER = 3
"""Id of the move."""


@pytest.fixture
def sim(graph: Graph) -> PalletSimNode:
    return start_pallet_sim(graph)


@pytest.fixture
def others(graph: Graph) -> dict[str, CellNode]:
    """Nodes of these names, which do nothing but live."""
    return {name: graph.start(partial(CellNode, name)) for name in OTHERS}


@pytest.fixture
def motion_node(graph: Graph, sim: PalletSimNode, others: dict[str, CellNode]) -> MotionNode:
    graph.probe.silence(motion.SETPOINTS)
    node = graph.start(MotionNode, watched=["sim", *OTHERS])
    graph.probe.listen(motion.MOTION_STATUS)
    graph.connect(motion.MOTION_TARGET)
    graph.wait_until(lambda: graph.probe.last(motion.MOTION_STATUS))
    graph.wait_until(lambda: all(node.hears(name) for name in ("sim", *OTHERS)))
    return node


def speed(graph: Graph) -> float:
    return float(np.abs(newest_joints(graph).v).max())


def begin_move(graph: Graph) -> None:
    target = MotionTarget(NUMBER, Path((PoseMove(GOAL),)))
    graph.probe.send(motion.MOTION_TARGET, to_target(target, newest_joints(graph).time))
    graph.wait_until(lambda: speed(graph) > FAST, 30.0)


def end_and_brake(graph: Graph, sim: PalletSimNode, node: CellNode) -> float:
    """End a node, wait until the arm stands, and return when its driver began to brake [s simulated].

    The speed would tell it later: an arm that was speeding up first has to lose its acceleration.
    """
    died = sim.simulator.time
    graph.stop(node)
    graph.wait_until(lambda: sim.simulator.follower.is_holding)
    began = sim.simulator.time
    graph.wait_until(lambda: speed(graph) < STANDING, 30.0)
    return began - died


def assert_goes_on(graph: Graph) -> None:
    """The same move is gone on with; test_lost_setpoints.py waits for the end of one."""
    graph.wait_until(lambda: speed(graph) > FAST, 60.0)
    graph.wait_until(lambda: graph.probe.last(motion.MOTION_STATUS).state == "MOVING")
    assert graph.probe.last(motion.MOTION_STATUS).id == NUMBER


def test_the_arm_brakes_when_a_node_dies_and_goes_on_when_it_is_back(
    graph: Graph, sim: PalletSimNode, motion_node: MotionNode, others: dict[str, CellNode]
) -> None:
    begin_move(graph)
    assert end_and_brake(graph, sim, others["vision"]) < BRAKES
    status = graph.probe.last(motion.MOTION_STATUS)
    assert status.state == "HELD"
    assert "silent: vision" in status.reason
    assert "node 'vision' is silent" in motion_node.health.faults["vision"]
    graph.start(partial(CellNode, "vision"))
    assert_goes_on(graph)


def test_a_move_is_given_up_when_the_node_dies_that_commands_it(
    graph: Graph, sim: PalletSimNode, motion_node: MotionNode, others: dict[str, CellNode]
) -> None:
    begin_move(graph)
    assert end_and_brake(graph, sim, others["fsm"]) < BRAKES
    stood = newest_joints(graph)
    graph.start(partial(CellNode, "fsm"))
    graph.wait_until(lambda: motion_node.hears("fsm"))
    graph.wait_until(lambda: newest_joints(graph).time > stood.time + 1.0, 30.0)
    np.testing.assert_allclose(newest_joints(graph).q, stood.q, atol=0.01)
    begin_move(graph)


def test_setpoints_of_two_senders_are_refused_and_both_are_named(
    graph: Graph, sim: PalletSimNode, motion_node: MotionNode
) -> None:
    begin_move(graph)
    graph.probe.publisher_of(motion.SETPOINTS)
    graph.wait_until(lambda: "one_sender" in sim.health.faults)
    named = sim.health.faults["one_sender"]
    assert "'motion'" in named
    assert "'probe'" in named
    graph.wait_until(lambda: speed(graph) < STANDING, 30.0)
    assert sim.health.counts["refused /joint_setpoints"] > 0
    graph.probe.silence(motion.SETPOINTS)
    graph.wait_until(lambda: "one_sender" not in sim.health.faults)
    assert_goes_on(graph)
