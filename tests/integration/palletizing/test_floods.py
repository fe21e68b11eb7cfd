"""A thousand setpoints a second: the driver drops what it cannot take, and its watchdog and its stop work."""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Iterator

import numpy as np
import pytest
from pack_interfaces.srv import StopArm

from integration.harness import Graph
from integration.palletizing.pallet_rig import joint_samples, newest_joints, start_pallet_sim
from pack_core.ros.contracts import motion, shared
from pack_sim.palletizing.pallet_sim_node import PalletSimNode

FLOOD = """
import sys, time
import numpy as np
import rclpy
from pack_core.joints import JointSample, Setpoints
from pack_core.robots.kr210 import JOINTS
from pack_core.ros.contracts import motion
from pack_core.ros.messages.joints import from_joint_state, to_trajectory

rclpy.init(domain_id=int(sys.argv[1]))
node = rclpy.create_node("flood")
heard = []
contract = motion.JOINT_STATES
node.create_subscription(contract.type, contract.name, heard.append, 1)
publisher = node.create_publisher(motion.SETPOINTS.type, motion.SETPOINTS.name, motion.SETPOINTS.qos)
while not heard:
    rclpy.spin_once(node)
start = from_joint_state(heard[-1], JOINTS)
zeros = np.zeros((2, len(JOINTS)))
stands = Setpoints(start.time, np.array([0.0, 60.0]), zeros + start.q, zeros, a=zeros)
message = to_trajectory(stands, JOINTS)
print("floods", flush=True)
begun, sent = time.monotonic(), 0
while True:
    publisher.publish(message)
    sent += 1
    time.sleep(max(0.0, begun + sent / 1000.0 - time.monotonic()))
"""
ANSWER = 3.0
"""Time in which a flooded driver answers [s of wall clock]; the machine may run other tests besides."""


@pytest.fixture
def sim(graph: Graph) -> PalletSimNode:
    node = start_pallet_sim(graph)
    graph.probe.silence(motion.SETPOINTS)
    return node


@pytest.fixture
def flood(graph: Graph, sim: PalletSimNode) -> Iterator[subprocess.Popen[str]]:
    """A process that sends a thousand references a second, each of which has the arm stand."""
    domain = str(graph.context.get_domain_id())
    with subprocess.Popen([sys.executable, "-c", FLOOD, domain], stdout=subprocess.PIPE, text=True) as child:
        graph.wait_until(lambda: not sim.simulator.follower.is_holding, 20.0)
        yield child
        child.kill()


def test_the_driver_answers_stops_and_holds_under_a_flood(
    graph: Graph, sim: PalletSimNode, flood: subprocess.Popen[str]
) -> None:
    graph.probe.listen(shared.ARM_STATE)
    begun, since = time.monotonic(), newest_joints(graph).time
    answer = graph.call(shared.STOP_ARM, StopArm.Request(reason="flood"))
    assert answer.success
    assert time.monotonic() - begun < ANSWER
    graph.wait_until(lambda: graph.probe.last(shared.ARM_STATE).is_standing)
    graph.wait_until(lambda: sim.health.counts["refused /joint_setpoints"] > 0)
    assert "the arm was stopped (flood)" in sim.health.last["refused /joint_setpoints"]
    assert max(np.abs(sample.v).max() for sample in joint_samples(graph, since)) < 0.05


def test_the_watchdog_holds_the_arm_when_a_flood_ends(
    graph: Graph, sim: PalletSimNode, flood: subprocess.Popen[str]
) -> None:
    assert not sim.simulator.follower.is_holding
    flood.kill()
    graph.wait_until(lambda: sim.simulator.follower.is_holding, 10.0)
