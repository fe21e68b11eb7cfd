"""Publishes the topics of the simulated palletizing cell, each at its rate."""

from __future__ import annotations

from collections.abc import Iterable

import yaml
from pack_interfaces.msg import UnwantedContact
from rosgraph_msgs.msg import Clock
from std_msgs.msg import String

from pack_core import topics as shared_topics
from pack_core.palletizing import topics
from pack_core.palletizing.boxes import BoxBody
from pack_core.robots.kr210 import JOINTS
from pack_core.ros.contracts import motion, shared
from pack_core.ros.contracts import palletizing as contracts
from pack_core.ros.messages.conversions import to_stamp
from pack_core.ros.messages.joints import to_joint_state
from pack_core.ros.messages.motion import to_obstacles
from pack_core.ros.messages.palletizing import to_gripper_state
from pack_core.ros.messages.scene import to_scene
from pack_core.ros.node import CellNode
from pack_core.topics import steps_between
from pack_sim.palletizing.simulator import PalletSimulator
from pack_sim.palletizing.visitor_sensor import Observation


class CellPublisher:
    """Steps the physics from one tick of /clock to the next and publishes what is due.

    Args:
        node: the node that publishes.
        timestep: time step of the physics [s].
    """

    def __init__(self, node: CellNode, timestep: float) -> None:
        self._clock = node.advertise(shared.CLOCK)
        self._joints = node.advertise(motion.JOINT_STATES)
        self._gripper = node.advertise(contracts.GRIPPER_STATE)
        self._truth = node.advertise(contracts.TRUTH)
        self._contacts = node.advertise(contracts.CONTACTS)
        self._boxes = node.advertise(contracts.BOXES)
        self._obstacles = node.advertise(motion.MOTION_OBSTACLES)
        self._steps = steps_between(shared_topics.CLOCK_RATE, timestep)
        self.period = self._steps * timestep
        self._gripper_ticks = steps_between(topics.GRIPPER_RATE, self.period)
        self._truth_ticks = steps_between(topics.TRUTH_RATE, self.period)
        self._tick = 0

    def step(self, simulator: PalletSimulator) -> None:
        """Advance by one tick of /clock, `period` [s]."""
        for _ in range(self._steps):
            simulator.step()
        self._clock.publish(Clock(clock=to_stamp(simulator.time)))
        self._joints.publish(to_joint_state(simulator.joints(), JOINTS))
        for contact in simulator.contacts.finished(simulator.time):
            message = UnwantedContact(
                bodies=list(contact.bodies), force=contact.force, duration=contact.duration
            )
            message.header.stamp = to_stamp(contact.time)
            self._contacts.publish(message)
        self._tick += 1
        if self._tick % self._gripper_ticks == 0:
            self._gripper.publish(to_gripper_state(simulator.time, simulator.gripper.state))
        if self._tick % self._truth_ticks == 0:
            self._truth.publish(to_scene(simulator.truth()))

    def publish_obstacles(self, seen: Observation) -> None:
        """Publish the visitors that the sensor sees."""
        self._obstacles.publish(to_obstacles(seen.obstacles, seen.time))

    def publish_boxes(self, boxes: Iterable[BoxBody]) -> None:
        """Publish the boxes that are in the cell, as YAML."""
        rows = [{"name": box.name, "size": list(box.size), "mass": box.mass} for box in boxes]
        self._boxes.publish(String(data=yaml.safe_dump(rows)))
