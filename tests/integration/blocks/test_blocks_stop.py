"""Stopping the arm of the blocks cell in a move with a block, and pausing the cell."""

from __future__ import annotations

import pathlib

import numpy as np
import pytest

from foreign_driver.driver_nodes import ACTION, BlocksDriverNode
from integration.blocks.test_blocks_nodes import start_sim
from integration.harness import Graph
from integration.simulation_rig import assert_a_pause_loses_nothing, braking_time, pause, set_state, slowly
from pack_core.blocks.cell import blocks_cell
from pack_core.blocks.gripper import FingerCommand, FingerStatus
from pack_core.blocks.model import block_name
from pack_core.bodies import set_object_poses
from pack_core.joints import JointSample
from pack_core.motion.moves import JointMove, Path
from pack_core.motion.target import MotionTarget
from pack_core.robots.ur10e import JOINTS
from pack_core.ros.contracts import motion, shared
from pack_core.ros.messages.joints import from_joint_state
from pack_core.ros.messages.motion import to_target
from pack_motion.motion_node import MotionNode
from pack_sim.blocks.blocks_sim_node import BlocksSimNode

pytestmark = pytest.mark.usefixtures("nodes_are_given_time")

LOOK = np.array(blocks_cell().robot.look)
TURNED = LOOK + np.array([0.9, 0.0, 0.0, 0.0, 0.0, 0.0])
TURNED_THE_OTHER_WAY = LOOK - np.array([0.9, 0.0, 0.0, 0.0, 0.0, 0.0])
BRAKING = 1.0
"""The arm stands this long after a stop [s]."""
STANDS_ON = 0.3
"""An arm that is released is watched for so long without a move [s]."""
HELD = "a"


@pytest.fixture
def sim(request: pytest.FixtureRequest, graph: Graph, tmp_path: pathlib.Path) -> BlocksSimNode:
    """The cell's simulator, or the class that the test gives."""
    graph.probe.listen(shared.ARM_STATE, shared.SIMULATION_STATE, shared.REAL_TIME_FACTOR)
    return start_sim(graph, tmp_path, 0.4, getattr(request, "param", BlocksSimNode))


@pytest.fixture
def motion_node(graph: Graph, sim: BlocksSimNode) -> MotionNode:
    action = ACTION if isinstance(sim, BlocksDriverNode) else ""
    node = graph.start(MotionNode, cell="blocks", follow_joint_trajectory=action)
    graph.probe.listen(motion.MOTION_STATUS)
    graph.connect(motion.MOTION_TARGET)
    graph.wait_until(lambda: graph.probe.last(motion.MOTION_STATUS))
    graph.wait_until_ready("motion")
    return node


def joints(graph: Graph) -> JointSample:
    return from_joint_state(graph.probe.last(motion.JOINT_STATES), JOINTS)


def hand_over(graph: Graph, sim: BlocksSimNode) -> None:
    """Keep a block between the fingers until they hold it."""
    with sim.lock:
        sim.simulator.fingers.command(FingerCommand(0.0, 60.0))

    def is_held() -> bool:
        with sim.lock:
            simulator = sim.simulator
            if simulator.finger_state().status is FingerStatus.HOLDING:
                return True
            set_object_poses(simulator.model, simulator.data, {block_name(HELD): simulator.tool_pose()})
            dof = simulator.model.joint(block_name(HELD)).dofadr[0]
            simulator.data.qvel[dof : dof + 6] = 0.0
        return False

    graph.wait_until(is_held, 30.0)


def begin(graph: Graph, number: int, q: np.ndarray) -> None:
    """Send a move, and wait until the arm is fast."""
    target = MotionTarget(number, Path((JointMove(q),)), is_checked=False)
    graph.probe.send(motion.MOTION_TARGET, to_target(target, joints(graph).time))
    graph.wait_until(lambda: np.abs(joints(graph).v).max() > 0.6, 30.0)


@pytest.mark.parametrize(
    "sim",
    # by trajectories the palletizing arm is, with a box, in tests/integration/palletizing/test_pallet_stop.py
    [BlocksSimNode, pytest.param(BlocksDriverNode, marks=pytest.mark.long)],
    indirect=True,
)
def test_a_stopped_arm_keeps_its_block_and_takes_the_next_move(
    graph: Graph, sim: BlocksSimNode, motion_node: MotionNode
) -> None:
    hand_over(graph, sim)
    begin(graph, 1, TURNED)
    assert braking_time(graph) < BRAKING
    graph.wait_until(lambda: graph.probe.last(motion.MOTION_STATUS).state == "IDLE")
    refused = sim.health.counts["refused /joint_setpoints"]  # sent before the stop was heard of
    assert np.abs(joints(graph).q - TURNED).max() > 0.1
    rested = joints(graph)
    assert graph.call(shared.RESUME_ARM, shared.RESUME_ARM.type.Request()).success
    graph.wait_until(lambda: joints(graph).time > rested.time + STANDS_ON)
    np.testing.assert_allclose(joints(graph).q, rested.q, atol=1e-3)
    with slowly(sim):
        begin(graph, 2, TURNED_THE_OTHER_WAY)
    assert sim.health.counts["refused /joint_setpoints"] == refused
    graph.wait_until(lambda: graph.probe.last(motion.MOTION_STATUS).state == "REACHED", 60.0)
    with sim.lock:
        assert sim.simulator.finger_state().status is FingerStatus.HOLDING
        apart = sim.simulator.truth().objects[HELD].X_WO.p - sim.simulator.tool_pose().p
    assert np.linalg.norm(apart) < 0.005


def test_a_pause_in_a_move_loses_nothing(graph: Graph, sim: BlocksSimNode, motion_node: MotionNode) -> None:
    begin(graph, 1, TURNED)
    assert_a_pause_loses_nothing(graph, sim, motion_node)


@pytest.mark.parametrize(("state", "reason"), [(0, "/sim/reset"), (3, "Ctrl-C"), (9, "does not exist")])
def test_states_that_are_not_supported_are_refused_with_what_to_do_instead(
    graph: Graph, sim: BlocksSimNode, state: int, reason: str
) -> None:
    result = set_state(graph, state)
    assert result.result == 0
    assert reason in result.error_message


def test_the_state_is_told_on_request_and_to_late_listeners(graph: Graph, sim: BlocksSimNode) -> None:
    assert set_state(graph, 1).result == 101
    pause(graph)
    graph.wait_until(lambda: graph.probe.last(shared.SIMULATION_STATE).state == 2)
    request = shared.GET_SIMULATION_STATE.type.Request()
    assert graph.call(shared.GET_SIMULATION_STATE, request).state.state == 2
    late: list[object] = []
    contract = shared.SIMULATION_STATE
    graph.probe.create_subscription(contract.type, contract.name, late.append, contract.qos)
    graph.wait_until(lambda: late)
    # A node that is paused ends as any other does.
    graph.stop(sim)
