"""How the simulated KR 210 takes setpoints: good, stale and bad ones."""

from __future__ import annotations

import math
import re

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
REFUSED = "refused /joint_setpoints"
BAD = {
    "a position is not finite": ("positions", [math.nan] * 6),
    "setpoint q has shape": ("positions", [0.0] * 5),
    "velocity of joint_a1 is -9.000 rad/s; allowed: -2.038 to 2.038": ("velocities", [-9.0] + [0.0] * 5),
    "setpoint [qa] has shape": ("accelerations", []),
}
"""Columns that are refused in all points of a message, by what is said of them."""


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


def test_bad_setpoints_are_refused_counted_and_named_and_do_not_move_the_arm(graph: Graph) -> None:
    node = start_pallet_sim(graph)
    start = newest_joints(graph)
    for sent, (named, (column, value)) in enumerate(BAD.items(), start=1):
        bad = to_trajectory(ramp(start, 1.0), JOINTS)
        for point in bad.points:
            setattr(point, column, value)
        graph.probe.send(motion.SETPOINTS, bad)
        graph.wait_until(lambda sent=sent: node.health.counts[REFUSED] == sent)
        assert re.search(named, node.health.last[REFUSED])
    other_arm = to_trajectory(ramp(start, 1.0), [f"panda_joint{i}" for i in range(1, 7)])
    graph.probe.send(motion.SETPOINTS, other_arm)
    graph.wait_until(lambda: node.health.counts[REFUSED] == len(BAD) + 1)
    assert "expected each of ['joint_a1'" in node.health.last[REFUSED]
    node.report()
    graph.wait_until(lambda: "expected each of ['joint_a1'" in status_of(graph).message)
    status = status_of(graph)
    assert status.level == DiagnosticStatus.WARN
    assert {item.key: int(item.value) for item in status.values}[REFUSED] == len(BAD) + 1
    seen = newest_joints(graph).time
    graph.wait_until(lambda: newest_joints(graph).time > seen + 0.02)
    np.testing.assert_allclose(newest_joints(graph).q, start.q, atol=1e-4)
