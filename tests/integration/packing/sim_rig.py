"""A simulated cell for tests: started, moved, and heard."""

from __future__ import annotations

import numpy as np

from integration.harness import Graph
from pack_core.joints import JointSample, Setpoints
from pack_core.paths import config_path
from pack_core.robots.panda import PANDA
from pack_core.ros.contracts import packing as contracts
from pack_core.ros.contracts import shared
from pack_core.ros.contracts.contract import Contract
from pack_core.ros.messages.conversions import from_stamp
from pack_core.ros.messages.joints import from_joint_state
from pack_core.rotations import Array
from pack_sim.packing.sim_node import PackingSimNode

EXAMPLE = config_path("scenarios", "packing", "example.yaml")
SENSORS = (
    shared.CLOCK, contracts.JOINT_STATES, contracts.WRENCH,
    contracts.MARKERS, contracts.TRUTH, contracts.GRIPPER_STATE,
)  # fmt: skip
SLOW = 0.2
"""Real-time factor at which what the test does in between takes little simulated time."""
SPEED = 0.3
"""Of a joint that is moved [rad/s]."""
STEPS = 40


def start_sim(graph: Graph, factor: float = SLOW) -> PackingSimNode:
    """The simulator with the example's scene, once it is heard and hears the probe."""
    node = graph.start(PackingSimNode, scene=str(EXAMPLE), real_time_factor=factor)
    graph.probe.listen(*SENSORS, contracts.DESCRIPTION, shared.DIAGNOSTICS)
    graph.wait_until(
        lambda: all(graph.probe.last(contract) for contract in (*SENSORS, contracts.DESCRIPTION))
    )
    graph.connect(contracts.SETPOINTS)
    return node


def stamps_of(graph: Graph, contract: Contract) -> list[float]:
    """When what the probe heard was true [s], oldest first."""
    return [from_stamp(message.header.stamp) for message in graph.probe.mail[contract.name]]


def ramp(start: JointSample, duration: float) -> Setpoints:
    """Setpoints that turn the first joint at a constant speed from where it is."""
    offsets = np.linspace(0.0, duration, STEPS)
    q, v = np.tile(start.q, (STEPS, 1)), np.zeros((STEPS, 7))
    q[:, 0] += SPEED * offsets
    v[:, 0] = SPEED
    return Setpoints(start.time, offsets, q, v, np.zeros((STEPS, 7)))


def newest_joints(graph: Graph) -> JointSample:
    """The last joint state that the probe heard."""
    return from_joint_state(graph.probe.last(contracts.JOINT_STATES), PANDA.joints)


def joint_samples(graph: Graph, after: float) -> list[JointSample]:
    """All joint states that the probe heard since a time [s], oldest first."""
    mail = graph.probe.mail[contracts.JOINT_STATES.name]
    return [
        from_joint_state(message, PANDA.joints)
        for message in mail
        if from_stamp(message.header.stamp) > after
    ]


def speeds(sample: JointSample) -> Array:
    """Joint speeds `(7,)` [rad/s]."""
    return np.abs(sample.v)
