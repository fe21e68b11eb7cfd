"""The motion node: targets in, setpoints and status out, with a probe that plays the arm."""

from __future__ import annotations

from contextlib import suppress

import numpy as np
import pytest
from pack_interfaces.msg import MotionStatus as MotionStatusMsg
from rclpy.qos import ReliabilityPolicy

from integration.harness import Graph
from pack_core.joints import JointSample, Setpoints
from pack_core.motion.moves import JointMove, Move, Path, PoseMove
from pack_core.motion.target import MotionTarget
from pack_core.motion.world import Obstacle
from pack_core.robots.kr210 import JOINTS
from pack_core.ros.contracts import motion as contracts
from pack_core.ros.messages.joints import from_trajectory, to_joint_state
from pack_core.ros.messages.motion import to_obstacles, to_target
from pack_core.rotations import Array, Pose, from_rpy
from pack_motion.arm.arm import load_arm
from pack_motion.motion_node import MotionNode

HOME = load_arm("palletizing").home
PERIOD = 0.004
AHEAD = 0.035
"""Setpoints reach farther than this beyond the measurement that they answer [s]."""
GOAL = Pose(np.array([0.0, 0.7, 1.5]), from_rpy((np.pi, 0.0, 0.0)))
NEAR = Pose(np.array([0.0, 0.7, 1.5]), from_rpy((np.pi, 0.0, np.pi - 0.8)))
"""Reached without the half turn of the tool that the goal takes, for tests of what comes in between."""
FAR = Pose(np.array([9.0, 0.7, 1.5]), from_rpy((np.pi, 0.0, 0.0)))


class Arm:
    """Does what it is told, a period at a time."""

    def __init__(self, graph: Graph) -> None:
        self._graph, self.time, self.q = graph, 1.0, HOME.copy()
        self.references: list[Setpoints] = []
        graph.probe.listen(contracts.SETPOINTS, contracts.MOTION_STATUS)
        graph.connect(contracts.JOINT_STATES, contracts.MOTION_TARGET, contracts.MOTION_OBSTACLES)
        self._be_heard()
        self.tick()

    @property
    def status(self) -> MotionStatusMsg:
        return self._graph.probe.last(contracts.MOTION_STATUS)

    def _be_heard(self) -> None:
        """Send a joint state until one is answered: the first may come before the node knows their sender."""
        answers = self._graph.probe.mail[contracts.MOTION_STATUS.name]
        sample = JointSample(self.time, self.q, np.zeros(6), np.zeros(6))
        while not answers:
            self._graph.probe.send(contracts.JOINT_STATES, to_joint_state(sample, JOINTS))
            with suppress(AssertionError):
                self._graph.wait_until(lambda: bool(answers), timeout=1.0)

    def tick(self) -> None:
        """One joint state, and the setpoints that answer it, or none while the arm is held."""
        setpoints, answers = (
            self._graph.probe.mail[contract.name]
            for contract in (contracts.SETPOINTS, contracts.MOTION_STATUS)
        )
        heard = len(answers)
        sample = JointSample(self.time, self.q, np.zeros(6), np.zeros(6))
        self._graph.probe.send(contracts.JOINT_STATES, to_joint_state(sample, JOINTS))
        self._graph.wait_until(lambda: len(answers) > heard)
        if self.status.state != "HELD":
            self._graph.wait_until(
                lambda: from_trajectory(setpoints[-1], JOINTS, "a").end > self.time + AHEAD
            )
        reference = from_trajectory(setpoints[-1], JOINTS, "a")
        self.references.append(reference)
        self.time += PERIOD
        self.q = reference.at(self.time)[0]

    def send(self, move: Move, number: int) -> None:
        self._graph.probe.send(contracts.MOTION_TARGET, to_target(MotionTarget(number, move), self.time))

    def until(self, *states: str, number: int, limit: int = 2000) -> str:
        """Tick until the target with this number is in one of the states."""
        for _ in range(limit):
            if self.status.id == number and self.status.state in states:
                return str(self.status.state)
            self.tick()
        raise AssertionError(f"still {self.status.state} {self.status.id} after {limit} periods")

    @property
    def accelerations(self) -> Array:
        """The highest of each joint between setpoints that came one after the other, at whatever tick."""
        v_at = {reference.time: reference.at(reference.time)[1] for reference in self.references}
        times = sorted(v_at)
        steps = np.diff([v_at[time] for time in times], axis=0) / np.diff(times)[:, None]
        return np.asarray(np.abs(steps).max(axis=0))


@pytest.fixture
def node(graph: Graph) -> MotionNode:
    return graph.start(MotionNode)


@pytest.fixture
def arm(graph: Graph, node: MotionNode) -> Arm:
    return Arm(graph)


def test_a_joint_state_that_is_lost_holds_up_none_that_follow(node: MotionNode) -> None:
    (listener,) = node.get_subscriptions_info_by_topic(contracts.JOINT_STATES.name)
    assert listener.qos_profile.reliability is ReliabilityPolicy.BEST_EFFORT


def test_a_target_is_reached_by_setpoints_that_stay_ahead(graph: Graph, arm: Arm) -> None:
    arm.send(Path((PoseMove(GOAL),)), 7)
    assert arm.until("REACHED", "STUCK", "REFUSED", number=7) == "REACHED"
    assert np.linalg.norm(load_arm("palletizing").chain.forward(arm.q).p - GOAL.p) < 1e-3
    for reference in arm.references:
        assert reference.offsets[-1] >= AHEAD
    assert np.all(arm.accelerations <= 1.01 * load_arm("palletizing").limits.acceleration)


def test_a_refused_target_is_answered_with_its_number_and_the_reason(graph: Graph, arm: Arm) -> None:
    arm.send(Path((PoseMove(FAR, label="far"),)), 8)
    assert arm.until("REACHED", "REFUSED", number=8) == "REFUSED"
    assert "'far'" in arm.status.reason
    assert "out of reach" in arm.status.reason
    np.testing.assert_allclose(arm.q, HOME, atol=1e-9)


def test_a_target_without_segments_stops_the_arm(graph: Graph, arm: Arm) -> None:
    arm.send(Path((PoseMove(NEAR),)), 7)
    arm.until("MOVING", number=7)
    for _ in range(60):
        arm.tick()
    arm.send(Path(()), 7)
    arm.until("REACHED", number=7)
    assert np.linalg.norm(load_arm("palletizing").chain.forward(arm.q).p - NEAR.p) > 0.01
    assert arm.status.label == "stop"


def test_a_message_that_must_not_be_used_is_dropped_and_counted(
    graph: Graph, node: MotionNode, arm: Arm
) -> None:
    message = to_target(MotionTarget(9, Path((PoseMove(NEAR),))), arm.time)
    message.segments[0].mode = "HASTY"
    graph.probe.send(contracts.MOTION_TARGET, message)
    graph.wait_until(lambda: node.health.counts["refused /motion/target"] == 1)
    assert "HASTY" in node.health.last["refused /motion/target"]
    assert arm.status.id != 9
    arm.tick()


def test_time_that_goes_back_starts_over_from_where_the_arm_is(graph: Graph, arm: Arm) -> None:
    arm.send(Path((PoseMove(NEAR),)), 7)
    arm.until("MOVING", number=7)
    arm.time, arm.q = 0.5, HOME.copy()
    arm.tick()
    assert arm.status.state == "IDLE"
    np.testing.assert_allclose(arm.q, HOME, atol=1e-9)


def test_a_target_that_waits_through_a_gap_in_time_is_still_taken(graph: Graph, arm: Arm) -> None:
    arm.send(Path((PoseMove(NEAR),)), 7)
    arm.tick()
    arm.time += 1.0
    assert arm.until("REACHED", "STUCK", number=7) == "REACHED"


def test_a_move_that_a_gap_in_time_interrupts_goes_on_when_the_arm_stands(
    graph: Graph, node: MotionNode, arm: Arm
) -> None:
    arm.send(Path((PoseMove(NEAR),)), 7)
    arm.until("MOVING", number=7)
    for _ in range(60):
        arm.tick()
    arm.time += 1.0
    arm.tick()
    assert (arm.status.state, arm.status.id) == ("HELD", 7)
    assert "no joint states for 1.0" in arm.status.reason
    assert node.health.counts["interrupted"] == 1
    assert arm.until("REACHED", "STUCK", "REFUSED", number=7) == "REACHED"
    assert np.linalg.norm(load_arm("palletizing").chain.forward(arm.q).p - NEAR.p) < 1e-3


def test_a_target_that_comes_while_the_arm_is_held_replaces_the_old_one(graph: Graph, arm: Arm) -> None:
    arm.send(Path((PoseMove(NEAR),)), 7)
    arm.until("MOVING", number=7)
    for _ in range(60):
        arm.tick()
    arm.time += 1.0
    arm.tick()
    arm.send(Path((JointMove(HOME),)), 8)
    assert arm.until("REACHED", "STUCK", "REFUSED", number=8) == "REACHED"
    np.testing.assert_allclose(arm.q, HOME, atol=1e-3)


def test_margins_are_told_while_somebody_is_seen(graph: Graph, arm: Arm) -> None:
    """Three metres beside the arm's home, who stands still: the margin is less than the distance."""
    graph.probe.listen(contracts.SEPARATION)
    told = graph.probe.mail[contracts.SEPARATION.name]
    arm.tick()
    assert not told
    X_WT = load_arm("palletizing").chain.forward(HOME)
    X_WO = Pose(np.array([X_WT.p[0], X_WT.p[1] + 3.0, 0.9]))
    person = Obstacle("person", X_WO, np.array([0.5, 0.5, 1.8]), is_moving=True)

    def is_told() -> bool:
        graph.probe.send(contracts.MOTION_OBSTACLES, to_obstacles((person,), arm.time))
        arm.tick()
        return bool(told)

    graph.wait_until(is_told)
    assert told[-1].who == "person"
    assert 0.0 < told[-1].margin < told[-1].distance < 3.0
    assert not told[-1].is_under_way
