"""Publishes the data of the simulated driver and its sensors, each topic at its rate."""

from __future__ import annotations

from collections.abc import Sequence

from pack_interfaces.msg import GripperState
from std_msgs.msg import Header

from pack_core import topics as shared_topics
from pack_core.packing import topics
from pack_core.ros.contracts import packing as contracts
from pack_core.ros.contracts import shared
from pack_core.ros.messages.conversions import to_stamp
from pack_core.ros.messages.packing import to_markers
from pack_core.ros.messages.serialized import ClockWriter, JointStateWriter, SceneWriter, WrenchWriter
from pack_core.ros.node import CellNode
from pack_core.topics import steps_between
from pack_sim.packing.simulator import Simulator


class SensorPublisher:
    """Steps the physics from one tick to the next and publishes what is due.

    Args:
        node: the node that publishes.
        timestep: step of the physics [s].
        joints: names of the arm's joints.
    """

    def __init__(self, node: CellNode, timestep: float, joints: Sequence[str]) -> None:
        self._clock, self._clock_writer = node.advertise(shared.CLOCK), ClockWriter()
        self._joints, self._joint_writer = node.advertise(contracts.JOINT_STATES), JointStateWriter(joints)
        self._wrench, self._wrench_writer = node.advertise(contracts.WRENCH), WrenchWriter("tip")
        self._zeroed = node.advertise(contracts.WRENCH_ZEROED)
        self._told_zeroed: float | None = None
        self._markers = node.advertise(contracts.MARKERS)
        self._truth, self._truth_writer = node.advertise(contracts.TRUTH), SceneWriter()
        self._gripper = node.advertise(contracts.GRIPPER_STATE)
        self._steps = steps_between(shared_topics.TICK_RATE, timestep)
        self._joint_steps = steps_between(topics.JOINT_RATE, timestep)
        self.period = self._steps * timestep
        self._clock_ticks = steps_between(shared_topics.CLOCK_RATE, self.period)
        self._truth_ticks = steps_between(topics.TRUTH_RATE, self.period)
        self._gripper_ticks = steps_between(topics.GRIPPER_RATE, self.period)
        self._tick = 0

    def step(self, simulator: Simulator) -> None:
        """Advance by one tick, `period` [s]."""
        samples = []
        for i in range(1, self._steps + 1):
            simulator.step()
            if i % self._joint_steps == 0:
                samples.append(simulator.joints())
        # Together at the end, so that whoever listens wakes up once a tick.
        for sample in samples:
            self._joints.publish(self._joint_writer.write(sample))
        self._wrench.publish(self._wrench_writer.write(simulator.time, *simulator.external_wrench()))
        if simulator.zeroed != self._told_zeroed:
            self._told_zeroed = simulator.zeroed
            self._zeroed.publish(Header(stamp=to_stamp(simulator.zeroed), frame_id="tip"))
        for frame in simulator.mocap.due(simulator.time):
            self._markers.publish(to_markers(frame))
        self._tick += 1
        if self._tick % self._clock_ticks == 0:
            self._clock.publish(self._clock_writer.write(simulator.time))
        if self._tick % self._truth_ticks == 0:
            self._truth.publish(self._truth_writer.write(simulator.truth()))
        if self._tick % self._gripper_ticks == 0:
            self._gripper.publish(_gripper_state(simulator))


def _gripper_state(simulator: Simulator) -> GripperState:
    state, load = simulator.pump.state, simulator.pump.state.load
    message = GripperState(
        is_closed=state.is_closed, object=simulator.scene.new_object.name if state.is_closed else "",
        coaxial_force=load.pull, shear_force=load.shear, moment=load.moment,
        release_reason=state.release_reason,
    )  # fmt: skip
    message.header.stamp = to_stamp(simulator.time)
    return message
