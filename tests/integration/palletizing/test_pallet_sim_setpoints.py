"""How the simulated KR 210 takes setpoints: good, stale and bad ones."""

from __future__ import annotations

import math

import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticStatus

from integration.harness import Graph
from integration.palletizing.pallet_rig import SPEED, joint_samples, newest_joints, ramp, start_pallet_sim
from integration.simulation_rig import FRESH, accept_times, standing_without_setpoints
from pack_core.robots.kr210 import JOINTS
from pack_core.ros.contracts import motion, shared
from pack_core.ros.messages.joints import to_trajectory

WATCHDOG = 0.1
MARGIN = 0.07
"""What braking by a twentieth of the speed takes, and some steps [s]."""


def status_of(graph: Graph) -> DiagnosticStatus:
    messages = graph.probe.mail[shared.DIAGNOSTICS.name]
    return messages[-1].status[0] if messages else DiagnosticStatus()


def test_the_arm_follows_setpoints_and_brakes_when_they_grow_stale(graph: Graph) -> None:
    node = start_pallet_sim(graph)
    accepted = accept_times(node)
    with standing_without_setpoints(node, accepted):
        # Setpoints begin where the arm is when they come: time stands until then.
        stands = node.simulator.time + FRESH
        graph.wait_until(lambda: newest_joints(graph).time >= stands)
        start = newest_joints(graph)
        reference = to_trajectory(ramp(start, 5.0), JOINTS)
        while newest_joints(graph).time < start.time + 0.5:
            taken = len(accepted)
            graph.probe.send(motion.SETPOINTS, reference)
            graph.wait_until(lambda taken=taken: len(accepted) > taken)
    graph.wait_until(lambda: newest_joints(graph).time > accepted[-1] + 0.6)
    samples = joint_samples(graph, start.time)
    assert max(sample.v[0] for sample in samples) == pytest.approx(SPEED, rel=0.05)
    last = max(sample.time for sample in samples if sample.v[0] > 0.95 * SPEED)
    assert WATCHDOG < last - accepted[-1] < WATCHDOG + MARGIN
    assert abs(newest_joints(graph).v[0]) < 0.02
    assert node.simulator.follower.is_holding


@pytest.mark.parametrize(
    ("column", "value", "named"),
    [
        ("positions", [math.nan] * 6, "a position is not finite"),
        ("positions", [0.0] * 5, "setpoint q has shape"),
        ("velocities", [-9.0] + [0.0] * 5, "velocity of joint_a1 is -9.000 rad/s; allowed: -2.038 to 2.038"),
        ("accelerations", [], "setpoint q has shape|setpoint a has shape"),
    ],
)
def test_bad_setpoints_are_refused_counted_and_named(
    graph: Graph, column: str, value: list[float], named: str
) -> None:
    node = start_pallet_sim(graph)
    start = newest_joints(graph)
    bad = to_trajectory(ramp(start, 1.0), JOINTS)
    for point in bad.points:
        setattr(point, column, value)
    for _ in range(3):
        graph.probe.send(motion.SETPOINTS, bad)
        seen = newest_joints(graph).time
        graph.wait_until(lambda seen=seen: newest_joints(graph).time > seen + 0.02)
    node.report()
    graph.wait_until(lambda: status_of(graph).level == DiagnosticStatus.WARN)
    status = status_of(graph)
    assert any(part in status.message for part in named.split("|"))
    counts = {item.key: int(item.value) for item in status.values}
    assert counts["refused /joint_setpoints"] >= 1
    np.testing.assert_allclose(newest_joints(graph).q, start.q, atol=1e-4)


def test_setpoints_for_another_arm_are_refused(graph: Graph) -> None:
    node = start_pallet_sim(graph)
    bad = to_trajectory(ramp(newest_joints(graph), 1.0), [f"panda_joint{i}" for i in range(1, 7)])
    graph.probe.send(motion.SETPOINTS, bad)
    graph.wait_until(lambda: node.health.counts["refused /joint_setpoints"] == 1)
    assert "expected each of ['joint_a1'" in node.health.last["refused /joint_setpoints"]
