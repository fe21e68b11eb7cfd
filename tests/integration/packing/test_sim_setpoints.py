"""How the simulated driver takes setpoints: good, stale and bad ones."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import repeat

import pytest
from diagnostic_msgs.msg import DiagnosticStatus
from trajectory_msgs.msg import JointTrajectory

from integration.harness import Graph
from integration.packing.sim_rig import SPEED, joint_samples, newest_joints, ramp, speeds, start_sim
from integration.simulation_rig import accept_times, standing_without_setpoints
from pack_core.joints import Setpoints
from pack_core.robots.panda import PANDA
from pack_core.ros.contracts import packing as contracts
from pack_core.ros.contracts import shared
from pack_core.ros.messages.joints import to_trajectory
from pack_core.ros.messages.serialized_setpoints import TrajectoryReader
from pack_sim.brakes import SLOW_DOWN
from pack_sim.packing.sim_node import PackingSimNode

AT_REST = 0.02
"""[rad/s]"""
DURATION = 0.3
"""Simulated time for which bad setpoints come [s]: longer than the watchdog waits."""
REFUSED = "refused /joint_torque_setpoints"
BAD = {
    "setpoint q: a position is not finite": ("positions", [math.nan] * 7),
    "(40, 6); allowed: (40, 7)": ("positions", [0.0] * 6),
    "position of panda_joint1 is 9.000 rad; allowed: -2.897 to 2.897": ("positions", [9.0] + [0.0] * 6),
    "velocity of panda_joint7 is -50.000 rad/s; allowed: -2.610 to 2.610": (
        "velocities", [0.0] * 6 + [-50.0],
    ),
    "torque of panda_joint1 is 1000.000 N m; allowed: -87.000 to 87.000": ("effort", [1e3] + [0.0] * 6),
}  # fmt: skip
"""Columns that are refused in all points of a message, by what is said of them."""


def test_the_arm_follows_setpoints_and_holds_when_they_grow_stale(graph: Graph) -> None:
    node = start_sim(graph)
    sent, accepted = newest_joints(graph), accept_times(node)
    graph.probe.send(contracts.SETPOINTS, to_trajectory(ramp(sent, 1.0), PANDA.joints))
    graph.wait_until(lambda: accepted and newest_joints(graph).time > accepted[0] + 0.4)
    samples = joint_samples(graph, sent.time)
    assert max(speeds(sample).max() for sample in samples) > 0.5 * SPEED
    moving = [sample.time for sample in samples if speeds(sample).max() > AT_REST]
    assert 0.09 + SLOW_DOWN < moving[-1] - accepted[0] < 0.16 + SLOW_DOWN
    assert node.simulator.follower.is_holding


@pytest.mark.parametrize("cause", ["stop", "death"])
def test_setpoints_that_waited_while_the_driver_was_told_to_stop_are_not_followed(
    graph: Graph, monkeypatch: pytest.MonkeyPatch, cause: str
) -> None:
    graph.failures_allowed = True
    node, read, convert = start_sim(graph), list[bytes](), TrajectoryReader.read

    def note(reader: TrajectoryReader, data: bytes) -> Setpoints:
        read.append(data)
        return convert(reader, data)

    monkeypatch.setattr(TrajectoryReader, "read", note)
    plan = to_trajectory(ramp(newest_joints(graph), 1.0), PANDA.joints)
    with node.lock:  # which they wait for next
        graph.probe.send(contracts.SETPOINTS, plan)
        graph.wait_until(lambda: read)
        node._drop()
        if cause == "stop":
            node._brake._begin("by hand")
        else:
            node._gate._is_abandoned = True
        now = node.simulator.time
    graph.wait_until(lambda: node.simulator.time > now + 0.03)
    assert node.simulator.follower.is_holding


def follow_and_send(
    graph: Graph, node: PackingSimNode, bad: Sequence[JointTrajectory]
) -> tuple[float, set[str]]:
    """Stream a good ramp, with bad setpoints in between, by turns.

    Returns:
        The speed at which the joint went on [rad/s], and the reasons for which setpoints were refused.
    """
    start, accepted = newest_joints(graph), accept_times(node)
    good, reasons = to_trajectory(ramp(start, 2.0), PANDA.joints), set[str]()
    passed, bad_ones = (0.1, 0.1 + DURATION), iter([*bad, *repeat(bad[-1], 1000)])
    with standing_without_setpoints(node, accepted):
        while newest_joints(graph).time < start.time + passed[1]:
            dealt_with = len(accepted) + refused(node)
            is_bad_due = newest_joints(graph).time > start.time + passed[0]
            for message in (good, next(bad_ones)) if is_bad_due else (good,):
                dealt_with += 1
                graph.probe.send(contracts.SETPOINTS, message)
                graph.wait_until(lambda least=dealt_with: len(accepted) + refused(node) >= least)
            reasons.add(node.health.last.get(REFUSED, ""))
    before, after = joint_samples(graph, start.time + passed[0])[0], newest_joints(graph)
    return float(after.q[0] - before.q[0]) / (after.time - before.time), reasons


def refused(node: PackingSimNode) -> int:
    """How many setpoints the driver has refused."""
    return node.health.counts[REFUSED]


def test_bad_setpoints_are_refused_counted_and_named_while_the_arm_goes_on(graph: Graph) -> None:
    node = start_sim(graph)
    messages = [to_trajectory(ramp(newest_joints(graph), 1.0), PANDA.joints) for _ in BAD]
    for message, (column, value) in zip(messages, BAD.values(), strict=True):
        for point in message.points:
            setattr(point, column, value)
    speed, reasons = follow_and_send(graph, node, messages)
    assert speed == pytest.approx(SPEED, rel=0.25)
    for named in BAD:
        assert any(named in reason for reason in reasons), (named, reasons)
    node.report()
    graph.wait_until(lambda: status_of(graph).level == DiagnosticStatus.WARN)
    status = status_of(graph)
    assert any(reason and reason in status.message for reason in reasons)
    counts = {item.key: int(item.value) for item in status.values}
    assert counts[REFUSED] >= len(BAD)


def status_of(graph: Graph) -> DiagnosticStatus:
    messages = graph.probe.mail[shared.DIAGNOSTICS.name]
    return messages[-1].status[0] if messages else DiagnosticStatus()
