"""A simulated palletizing cell for tests: started, moved, and heard."""

from __future__ import annotations

import numpy as np
from pack_interfaces.srv import SpawnBox

from integration.harness import Graph
from pack_core.joints import JointSample, Setpoints
from pack_core.robots.kr210 import JOINTS
from pack_core.ros.contracts import motion, shared
from pack_core.ros.contracts import palletizing as contracts
from pack_core.ros.messages.conversions import from_stamp
from pack_core.ros.messages.joints import from_joint_state
from pack_sim.palletizing.pallet_sim_node import PalletSimNode

SENSORS = (shared.CLOCK, motion.JOINT_STATES, contracts.GRIPPER_STATE, contracts.TRUTH)
SLOW = 0.3
"""Real-time factor at which what the test does in between takes little simulated time."""
SPEED = 0.5
"""Of the first joint when it is moved [rad/s]."""
RISE = SPEED / 1.5
"""Time in which it gets there [s]."""


def start_pallet_sim(
    graph: Graph, factor: float = SLOW, make: type[PalletSimNode] = PalletSimNode, **parameters: object
) -> PalletSimNode:
    """The simulator, once it is heard and hears the probe."""
    node = graph.start(make, **{"real_time_factor": factor, "camera.width": 640, **parameters})
    graph.probe.listen(*SENSORS, contracts.BOXES, contracts.CONTACTS, shared.DIAGNOSTICS)
    graph.wait_until(lambda: all(graph.probe.last(contract) for contract in (*SENSORS, contracts.BOXES)))
    graph.connect(motion.SETPOINTS)
    return node


def spawn(graph: Graph, name: str = "box") -> SpawnBox.Response:
    """Have a box of 0.4 x 0.3 x 0.25 m arrive."""
    request = SpawnBox.Request(name=name, size=np.array([0.4, 0.3, 0.25]), mass=8.0)
    return graph.call(contracts.SPAWN_BOX, request)


def newest_joints(graph: Graph) -> JointSample:
    """The last joint state that the probe heard."""
    return from_joint_state(graph.probe.last(motion.JOINT_STATES), JOINTS)


def joint_samples(graph: Graph, after: float) -> list[JointSample]:
    """All joint states that the probe heard since a time [s], oldest first."""
    mail = graph.probe.mail[motion.JOINT_STATES.name]
    return [from_joint_state(message, JOINTS) for message in mail if from_stamp(message.header.stamp) > after]


def ramp(start: JointSample, duration: float) -> Setpoints:
    """A reference that brings the first joint from rest to `SPEED` and keeps it there."""
    offsets = np.arange(0.0, duration, 0.01)
    early = np.minimum(offsets, RISE)
    q, v, a = np.tile(start.q, (len(offsets), 1)), np.zeros((len(offsets), 6)), np.zeros((len(offsets), 6))
    a[:, 0] = np.where(offsets < RISE, SPEED / RISE, 0.0)
    v[:, 0] = SPEED / RISE * early
    q[:, 0] += 0.5 * SPEED / RISE * early**2 + SPEED * (offsets - early)
    return Setpoints(start.time, offsets, q, v, a=a)
