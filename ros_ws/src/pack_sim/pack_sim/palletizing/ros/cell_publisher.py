"""What the simulated palletizing cell publishes, each at its rate."""

from __future__ import annotations

from collections.abc import Iterable

import yaml
from pack_interfaces.msg import UnwantedContact
from rosgraph_msgs.msg import Clock
from std_msgs.msg import String

from pack_core.palletizing.box_body import BoxBody
from pack_core.robots.kr210 import JOINTS
from pack_core.ros.cell_node import CellNode
from pack_core.ros.contracts import motion, shared
from pack_core.ros.contracts import palletizing as contracts
from pack_core.ros.conversions import to_stamp
from pack_core.ros.joint_messages import to_joint_state
from pack_core.ros.palletizing.gripper_messages import to_gripper_state
from pack_core.ros.scene_messages import to_scene
from pack_sim.palletizing.simulator import PalletSimulator

BLOCK = 2
"""Physics steps between two ticks of /clock."""
GRIPPER_EVERY = 2
TRUTH_EVERY = 5


class CellPublisher:
    """Steps the physics in blocks and publishes what is due."""

    def __init__(self, node: CellNode) -> None:
        self._clock = node.advertise(shared.CLOCK)
        self._joints = node.advertise(motion.JOINT_STATES)
        self._gripper = node.advertise(contracts.GRIPPER_STATE)
        self._truth = node.advertise(contracts.TRUTH)
        self._contacts = node.advertise(contracts.CONTACTS)
        self._boxes = node.advertise(contracts.BOXES)
        self._block = 0

    def step(self, simulator: PalletSimulator) -> None:
        """Advance by one block."""
        for _ in range(BLOCK):
            simulator.step()
        self._clock.publish(Clock(clock=to_stamp(simulator.time)))
        self._joints.publish(to_joint_state(simulator.joints(), JOINTS))
        for contact in simulator.contacts.finished(simulator.time):
            message = UnwantedContact(
                bodies=list(contact.bodies), force=contact.force, duration=contact.duration
            )
            message.header.stamp = to_stamp(contact.time)
            self._contacts.publish(message)
        self._block += 1
        if self._block % GRIPPER_EVERY == 0:
            self._gripper.publish(to_gripper_state(simulator.time, simulator.gripper.state))
        if self._block % TRUTH_EVERY == 0:
            self._truth.publish(to_scene(simulator.truth()))

    def publish_boxes(self, boxes: Iterable[BoxBody]) -> None:
        """Say which boxes there are."""
        rows = [{"name": box.name, "size": list(box.size), "mass": box.mass} for box in boxes]
        self._boxes.publish(String(data=yaml.safe_dump(rows)))
