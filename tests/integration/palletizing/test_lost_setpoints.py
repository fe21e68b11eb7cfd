"""Setpoints that are lost in a move: the driver holds the arm, and the motion goes on from there."""

from __future__ import annotations

import numpy as np
import pytest

from integration.harness import Graph
from integration.palletizing.pallet_rig import joint_samples, newest_joints, start_pallet_sim
from pack_core.joints import Setpoints
from pack_core.motion.moves import Move, Path, PoseMove
from pack_core.motion.target import MotionTarget
from pack_core.robots.kr210 import LIMITS
from pack_core.ros.contracts import motion
from pack_core.ros.messages.conversions import from_stamp
from pack_core.ros.messages.joints import to_trajectory
from pack_core.ros.messages.motion import to_target
from pack_core.rotations import Pose, from_rpy
from pack_motion.arm.arm import load_arm
from pack_motion.motion_node import MotionNode
from pack_sim.palletizing.pallet_sim_node import PalletSimNode

GOAL = Pose(np.array([-2.3, 2.4, 1.3]), from_rpy((np.pi, 0.0, 0.0)))
JOLT = 1.5
"""Of the acceleration limits: what the servo makes of references within them; a jump makes tens of it."""
MOVE = Path((PoseMove(GOAL),))


class Deaf:
    """A driver that loses what it is sent, while it is deaf."""

    def __init__(self, node: PalletSimNode) -> None:
        self._accept, self.is_deaf = node.simulator.accept, False
        node.simulator.accept = self.accept  # type: ignore[method-assign]

    def accept(self, setpoints: Setpoints) -> None:
        if not self.is_deaf:
            self._accept(setpoints)


@pytest.fixture
def sim(graph: Graph) -> PalletSimNode:
    return start_pallet_sim(graph)


@pytest.fixture
def motion_node(graph: Graph, sim: PalletSimNode) -> MotionNode:
    graph.probe.silence(motion.SETPOINTS)
    node = graph.start(MotionNode)
    graph.probe.listen(motion.MOTION_STATUS)
    graph.connect(motion.MOTION_TARGET)
    graph.wait_until(lambda: graph.probe.last(motion.MOTION_STATUS))
    return node


def begin(graph: Graph, move: Move) -> None:
    """Send a move, and wait until the arm is fast."""
    graph.probe.send(motion.MOTION_TARGET, to_target(MotionTarget(3, move), newest_joints(graph).time))
    graph.wait_until(lambda: np.abs(newest_joints(graph).v).max() > 0.8, 30.0)


def states(graph: Graph) -> list[str]:
    """Of the motion, each once in a row."""
    mail = [message.state for message in graph.probe.mail[motion.MOTION_STATUS.name] if message.id == 3]
    return [state for i, state in enumerate(mail) if i == 0 or state != mail[i - 1]]


def test_a_move_goes_on_after_its_setpoints_were_lost_and_the_arm_never_jumps(
    graph: Graph, sim: PalletSimNode, motion_node: MotionNode
) -> None:
    driver, start = Deaf(sim), newest_joints(graph).time
    begin(graph, MOVE)
    # Until that is noticed, and not for some time, in which the motion may hold the arm for another reason,
    # as for a sim that is too busy to be heard.
    driver.is_deaf = True
    graph.wait_until(lambda: motion_node.health.counts["interrupted"] >= 1)
    driver.is_deaf = False
    graph.wait_until(lambda: graph.probe.last(motion.MOTION_STATUS).state == "REACHED", 60.0)
    reached = from_stamp(graph.probe.last(motion.MOTION_STATUS).header.stamp)
    graph.wait_until(lambda: newest_joints(graph).time >= reached)
    assert "HELD" in states(graph)
    assert states(graph)[-1] == "REACHED"
    assert np.linalg.norm(load_arm("palletizing").chain.forward(newest_joints(graph).q).p - GOAL.p) < 2e-3
    rows = joint_samples(graph, start)
    v, t = np.array([row.v for row in rows]), np.array([row.time for row in rows])
    accelerations = np.diff(v, axis=0) / np.diff(t)[:, None]
    assert np.all(np.abs(accelerations) < JOLT * LIMITS.acceleration)


def test_a_stream_that_begins_far_from_the_held_arm_is_refused_counted_and_named(
    graph: Graph, sim: PalletSimNode
) -> None:
    stands = newest_joints(graph)
    rest = np.zeros((2, 6))
    far = Setpoints(stands.time, np.array([0.0, 9.0]), np.tile(stands.q + 0.2, (2, 1)), rest, a=rest)
    graph.probe.send(motion.SETPOINTS, to_trajectory(far, LIMITS.names))
    graph.wait_until(lambda: sim.health.counts["refused /joint_setpoints"] == 1)
    assert "joint_a2 +0.2000 rad from where the arm was held" in sim.health.status().message
    graph.wait_until(lambda: newest_joints(graph).time > stands.time + 0.1)
    np.testing.assert_allclose(newest_joints(graph).q, stands.q, atol=1e-5)
