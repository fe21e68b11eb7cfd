"""What the simulated palletizing cell publishes: its state, each topic at its rate, and scans."""

from __future__ import annotations

from collections.abc import Iterable

import yaml
from pack_interfaces.msg import UnwantedContact
from std_msgs.msg import String

from pack_core import topics as shared_topics
from pack_core.palletizing import topics
from pack_core.palletizing.boxes import BoxBody
from pack_core.palletizing.infeed import PlacesAway
from pack_core.robots.kr210 import JOINTS
from pack_core.ros.contracts import motion, shared
from pack_core.ros.contracts import palletizing as contracts
from pack_core.ros.messages.conversions import to_stamp
from pack_core.ros.messages.motion import to_obstacles
from pack_core.ros.messages.palletizing import to_cloud, to_gripper_state, to_infeed, to_places
from pack_core.ros.messages.serialized import ClockWriter, JointStateWriter, SceneWriter
from pack_core.ros.node import CellNode
from pack_core.topics import steps_between
from pack_sim.palletizing.place_scanner import PhysicsSnapshot, PlaceScanner
from pack_sim.palletizing.simulator import PalletSimulator
from pack_sim.palletizing.visitor_sensor import Observation


class CellPublisher:
    """Steps the physics from one tick to the next and publishes what is due.

    Args:
        node: the node that publishes.
        timestep: time step of the physics [s].
    """

    def __init__(self, node: CellNode, timestep: float) -> None:
        self._clock, self._clock_writer = node.advertise(shared.CLOCK), ClockWriter()
        self._joints, self._joint_writer = node.advertise(motion.JOINT_STATES), JointStateWriter(JOINTS)
        self._gripper = node.advertise(contracts.GRIPPER_STATE)
        self._truth, self._truth_writer = node.advertise(contracts.TRUTH), SceneWriter()
        self._contacts = node.advertise(contracts.CONTACTS)
        self._boxes = node.advertise(contracts.BOXES)
        self._obstacles = node.advertise(motion.MOTION_OBSTACLES)
        self._infeed = node.advertise(contracts.INFEED_STATE)
        self._places = node.advertise(contracts.PALLET_PLACES)
        self._told: tuple[object, ...] = ()
        self._steps = steps_between(shared_topics.TICK_RATE, timestep)
        self.period = self._steps * timestep
        self._gripper_ticks = steps_between(topics.GRIPPER_RATE, self.period)
        self._clock_ticks = steps_between(shared_topics.CLOCK_RATE, self.period)
        self._truth_ticks = steps_between(topics.TRUTH_RATE, self.period)
        self._tick = 0

    def step(self, simulator: PalletSimulator) -> None:
        """Advance by one tick, `period` [s]."""
        for _ in range(self._steps):
            simulator.step()
        self._joints.publish(self._joint_writer.write(simulator.joints()))
        for contact in simulator.contacts.finished(simulator.time):
            message = UnwantedContact(
                bodies=list(contact.bodies), force=contact.force, duration=contact.duration
            )
            message.header.stamp = to_stamp(contact.time)
            self._contacts.publish(message)
        self._tick += 1
        if self._tick % self._clock_ticks == 0:
            self._clock.publish(self._clock_writer.write(simulator.time))
        if self._tick % self._gripper_ticks == 0:
            self._gripper.publish(to_gripper_state(simulator.time, simulator.gripper.state))
        if self._tick % self._truth_ticks == 0:
            self._truth.publish(self._truth_writer.write(simulator.truth()))
        self._tell_of_shift(simulator)

    def _tell_of_shift(self, simulator: PalletSimulator) -> None:
        """Publish what the conveyor tells, the pallets' places and the boxes, once one has changed."""
        infeed, away = simulator.infeed, simulator.taken
        if infeed is None:
            return
        now = (infeed.number, infeed.box, infeed.label, away, simulator.boxes)
        if now != self._told:
            self._told = now
            self._infeed.publish(to_infeed(infeed))
            self._places.publish(to_places(PlacesAway(simulator.time, away)))
            self.publish_boxes(simulator.boxes)

    def publish_obstacles(self, seen: Observation) -> None:
        """Publish the visitors that the sensor sees."""
        self._obstacles.publish(to_obstacles(seen.obstacles, seen.time))

    def publish_boxes(self, boxes: Iterable[BoxBody]) -> None:
        """Publish the boxes that are in the cell, as YAML."""
        rows = [{"name": box.name, "size": list(box.size), "mass": box.mass} for box in boxes]
        self._boxes.publish(String(data=yaml.safe_dump(rows)))


class ScanPublisher:
    """Publishes scans.

    Args:
        node: the node that publishes.
        scanner: makes them.
        places: names of those that it looks at.
    """

    def __init__(self, node: CellNode, scanner: PlaceScanner, places: Iterable[str]) -> None:
        self._scanner = scanner
        self._points = {place: node.advertise(contracts.SCANS[place][1]) for place in places}

    def publish(self, place: str, still: PhysicsSnapshot) -> None:
        """Scan a place as it was when the physics was held still, and publish the points."""
        self._points[place].publish(to_cloud(self._scanner.scan(place, still)))
