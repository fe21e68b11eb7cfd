"""Stopping the arm of the palletizing cell in a move with a box, and pausing the cell."""

from __future__ import annotations

import numpy as np
import pytest

from foreign_driver.driver_nodes import ACTION, PalletDriverNode
from integration.harness import Graph
from integration.palletizing.pallet_rig import joint_samples, newest_joints, start_pallet_sim
from integration.simulation_rig import (
    WHO,
    assert_a_pause_loses_nothing,
    assert_no_jump,
    braking_time,
    slowly,
)
from pack_core.motion.moves import Path, PoseMove
from pack_core.motion.target import MotionTarget
from pack_core.palletizing.boxes import BoxBody
from pack_core.robots.kr210 import LIMITS
from pack_core.ros.contracts import motion, shared
from pack_core.ros.contracts import palletizing as contracts
from pack_core.ros.messages.conversions import from_stamp
from pack_core.ros.messages.motion import to_target
from pack_core.rotations import Pose, from_rpy
from pack_motion.motion_node import MotionNode
from pack_sim.palletizing.pallet_sim_node import PalletSimNode

pytestmark = pytest.mark.usefixtures("nodes_are_given_time")

MOVE = Path((PoseMove(Pose(np.array([-2.3, 2.4, 1.3]), from_rpy((np.pi, 0.0, 0.0)))),))
BRAKING = 1.2
"""The arm stands this long after a stop at 0.8 rad/s [s]."""
BOX = BoxBody("box", (0.4, 0.3, 0.25), 8.0)


@pytest.fixture
def sim(request: pytest.FixtureRequest, graph: Graph) -> PalletSimNode:
    """The cell's simulator, or the class that the test gives."""
    graph.probe.listen(shared.ARM_STATE)
    return start_pallet_sim(graph, 0.5, getattr(request, "param", PalletSimNode))


@pytest.fixture
def motion_node(graph: Graph, sim: PalletSimNode) -> MotionNode:
    graph.probe.silence(motion.SETPOINTS)
    action = ACTION if isinstance(sim, PalletDriverNode) else ""
    node = graph.start(MotionNode, follow_joint_trajectory=action)
    graph.probe.listen(motion.MOTION_STATUS)
    graph.connect(motion.MOTION_TARGET)
    graph.wait_until(lambda: graph.probe.last(motion.MOTION_STATUS))
    graph.wait_until_ready("motion")
    return node


def hand_over(graph: Graph, sim: PalletSimNode) -> None:
    """Put a box to the gripper's pad and have it gripped."""
    with sim.lock:
        below = Pose(np.array([0.0, 0.0, 0.5 * BOX.size[2] + 0.001]))
        sim.simulator.spawn(BOX, sim.simulator.tool_pose() @ below)
        sim.simulator.gripper.close()
    graph.wait_until(lambda: graph.probe.last(contracts.GRIPPER_STATE).is_closed)


def begin(graph: Graph, number: int) -> None:
    """Send a move, and wait until the arm is fast."""
    graph.probe.send(motion.MOTION_TARGET, to_target(MotionTarget(number, MOVE), newest_joints(graph).time))
    graph.wait_until(lambda: np.abs(newest_joints(graph).v).max() > 0.8, 30.0)


@pytest.mark.parametrize(
    "sim",
    # by setpoints the blocks' arm is stopped with a block, in tests/integration/blocks/test_blocks_stop.py
    [pytest.param(PalletSimNode, marks=pytest.mark.long), PalletDriverNode],
    indirect=True,
)
def test_a_stopped_arm_keeps_its_box_stays_where_it_is_and_takes_the_next_move(
    graph: Graph, sim: PalletSimNode, motion_node: MotionNode
) -> None:
    hand_over(graph, sim)
    begin(graph, 1)
    start = newest_joints(graph).time
    assert braking_time(graph) < BRAKING
    stands = from_stamp(graph.probe.last(shared.ARM_STATE).header.stamp)
    graph.wait_until(lambda: newest_joints(graph).time > stands)
    held = newest_joints(graph)
    graph.wait_until(lambda: graph.probe.last(motion.MOTION_STATUS).state == "IDLE")
    refused = sim.health.counts["refused /joint_setpoints"]  # sent before the stop was heard of
    assert graph.call(shared.RESUME_ARM, shared.RESUME_ARM.type.Request()).success
    graph.wait_until(lambda: newest_joints(graph).time > held.time + 0.5)
    np.testing.assert_allclose(newest_joints(graph).q, held.q, atol=2e-3)
    reasons = {message.reason for message in graph.probe.mail[motion.MOTION_STATUS.name]}
    assert any(f"the arm was stopped: {WHO}" in reason for reason in reasons)
    with slowly(sim):
        begin(graph, 2)
    assert sim.health.counts["refused /joint_setpoints"] == refused
    graph.wait_until(lambda: graph.probe.last(motion.MOTION_STATUS).state == "REACHED", 60.0)
    assert graph.probe.last(contracts.GRIPPER_STATE).is_closed
    rows = joint_samples(graph, start)
    v, t = np.array([row.v for row in rows]), np.array([row.time for row in rows])
    assert np.all(np.abs(np.diff(v, axis=0) / np.diff(t)[:, None]) < 1.5 * LIMITS.acceleration)


def test_a_pause_in_a_move_loses_nothing(graph: Graph, sim: PalletSimNode, motion_node: MotionNode) -> None:
    begin(graph, 1)
    stands = assert_a_pause_loses_nothing(graph, sim, motion_node)
    assert_no_jump(joint_samples(graph, stands - 0.1), stands, LIMITS.velocity)
