"""Moves of the blocks cell through a joint trajectory controller, which is no driver of the cell's own."""

from __future__ import annotations

import pathlib

import numpy as np
import pytest
from control_msgs.msg import SpeedScalingFactor
from rclpy.qos import DurabilityPolicy, QoSProfile

from foreign_driver.driver_nodes import ACTION, CONTROLLER, BlocksDriverNode
from integration.blocks.test_blocks_nodes import start_sim
from integration.harness import Graph
from integration.simulation_rig import slowly
from pack_core.blocks.cell import blocks_cell
from pack_core.motion.moves import JointMove, Path
from pack_core.motion.target import MotionTarget
from pack_core.ros.contracts import motion
from pack_core.ros.messages.motion import to_target
from pack_core.rotations import Array
from pack_motion.motion_node import MotionNode

LOOK = np.array(blocks_cell().robot.look)
TURN = np.array([0.5, 0.0, 0.0, 0.0, 0.0, 0.0])
NEAR = 1e-3
"""How near to its goal a joint is at the end of a move [rad]."""


class Cell:
    """The driver's node and the motion node, and moves that are sent to it."""

    def __init__(self, graph: Graph, sim: BlocksDriverNode) -> None:
        self.graph, self.sim, self._number = graph, sim, 0
        self.motion = graph.start(MotionNode, cell="blocks", follow_joint_trajectory=ACTION)
        graph.probe.listen(motion.MOTION_STATUS, motion.SETPOINTS)
        graph.connect(motion.MOTION_TARGET)
        graph.wait_until_ready("motion")

    @property
    def q(self) -> Array:
        return self.sim.simulator.joints().q

    @property
    def interruptions(self) -> int:
        """How often the motion took the arm for held, as where a busy machine keeps it waiting."""
        return self.motion.health.counts["interrupted"]

    @property
    def trajectories(self) -> int:
        """How many the driver has taken, but for one after each interruption."""
        return self.sim.controller.accepted - self.interruptions

    def send(self, *goals: Array) -> None:
        """A move through joint positions, without stops between them; without any, a stop of the last one."""
        self._number += bool(goals)
        target = MotionTarget(self._number, Path(tuple(map(JointMove, goals))), is_checked=False)
        self.graph.probe.send(motion.MOTION_TARGET, to_target(target, self.sim.simulator.time))

    def end(self) -> str:
        """How the newest move ended."""
        status = self.graph.probe.mail[motion.MOTION_STATUS.name]
        ended = ("REACHED", "REFUSED", "STUCK")
        self.graph.wait_until(lambda: status[-1].id == self._number and status[-1].state in ended, 60.0)
        return str(status[-1].state)

    def wait_until_fast(self, speed: float = 0.4) -> None:
        self.graph.wait_until(lambda: np.abs(self.sim.simulator.joints().v).max() > speed)


@pytest.fixture
def cell(graph: Graph, tmp_path: pathlib.Path) -> Cell:
    sim = start_sim(graph, tmp_path, 0.5, BlocksDriverNode)
    assert isinstance(sim, BlocksDriverNode)
    return Cell(graph, sim)


def test_moves_are_trajectories_that_a_stop_replaces_and_a_slider_slows(graph: Graph, cell: Cell) -> None:
    cell.send(LOOK + TURN, LOOK)
    assert cell.end() == "REACHED"
    np.testing.assert_allclose(cell.q, LOOK, atol=NEAR)
    assert cell.trajectories == 1, "the whole move is one trajectory"
    told = graph.probe.last(motion.SETPOINTS)  # for recordings, which are evaluated by them
    np.testing.assert_allclose(told.points[-1].positions, LOOK, atol=NEAR)

    cell.send(LOOK + TURN)
    cell.wait_until_fast()
    cell.send()  # no segments: stop
    assert cell.end() == "REACHED"
    assert cell.trajectories == 3
    assert np.abs(cell.q - LOOK - TURN).max() > 0.05

    latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    slider = graph.probe.create_publisher(SpeedScalingFactor, f"/{CONTROLLER}/speed_scaling_input", latched)
    cell.send(LOOK)
    cell.wait_until_fast()
    with slowly(cell.sim):
        interruptions = cell.interruptions
        slider.publish(SpeedScalingFactor(factor=0.0))
        graph.wait_until(lambda: np.abs(cell.sim.simulator.joints().v).max() < 1e-3)
    paused, begun = cell.q, cell.sim.simulator.time
    graph.wait_until(lambda: cell.sim.simulator.time > begun + 2.0)  # longer than a move may be stuck
    np.testing.assert_allclose(cell.q, paused, atol=NEAR)
    with slowly(cell.sim):
        slider.publish(SpeedScalingFactor(factor=0.5))
        cell.wait_until_fast(0.1)
        assert cell.interruptions == interruptions
    assert cell.end() == "REACHED"
    np.testing.assert_allclose(cell.q, LOOK, atol=NEAR)
    assert cell.trajectories == 4
    assert set(cell.motion.health.counts) <= {"interrupted"}
    assert not cell.sim.shell.rejections


def test_a_driver_that_gives_up_is_asked_again_and_one_that_refuses_ends_the_move(
    graph: Graph, cell: Cell
) -> None:
    cell.send(LOOK + TURN)
    cell.wait_until_fast()
    with cell.sim.lock:
        cell.sim.controller.give_up("a joint was held fast")
    assert cell.end() == "REACHED"
    np.testing.assert_allclose(cell.q, LOOK + TURN, atol=NEAR)
    # The goal's result says so, or the joints do, which are away from their setpoints; either may be first.
    assert cell.motion.health.counts["interrupted"]
    assert cell.sim.controller.accepted == 2

    cell.sim.refusal = "the controller is not active"
    cell.send(LOOK)
    assert cell.end() == "REFUSED"
    assert "rejected a trajectory" in graph.probe.last(motion.MOTION_STATUS).reason
    np.testing.assert_allclose(cell.q, LOOK + TURN, atol=NEAR)
    cell.sim.refusal = ""
    cell.send(LOOK)
    assert cell.end() == "REACHED"
