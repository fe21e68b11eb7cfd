"""Publishes the data of the simulated driver and its sensors, each topic at its rate."""

from __future__ import annotations

from pack_interfaces.msg import GripperState
from rosgraph_msgs.msg import Clock

from pack_core import topics as shared_topics
from pack_core.packing import topics
from pack_core.ros.contracts import packing as contracts
from pack_core.ros.contracts import shared
from pack_core.ros.messages.conversions import to_stamp, to_wrench
from pack_core.ros.messages.joints import to_joint_state
from pack_core.ros.messages.packing import to_markers
from pack_core.ros.messages.scene import SceneWriter
from pack_core.ros.node import CellNode
from pack_core.topics import steps_between
from pack_sim.packing.simulator import Simulator


class SensorPublisher:
    """Steps the physics from one tick of /clock to the next and publishes what is due.

    Args:
        node: the node that publishes.
        timestep: step of the physics [s].
    """

    def __init__(self, node: CellNode, timestep: float) -> None:
        self._clock = node.advertise(shared.CLOCK)
        self._joints = node.advertise(contracts.JOINT_STATES)
        self._wrench = node.advertise(contracts.WRENCH)
        self._markers = node.advertise(contracts.MARKERS)
        self._truth, self._writer = node.advertise(contracts.TRUTH), SceneWriter()
        self._gripper = node.advertise(contracts.GRIPPER_STATE)
        self._steps = steps_between(shared_topics.CLOCK_RATE, timestep)
        self._joint_steps = steps_between(topics.JOINT_RATE, timestep)
        self.period = self._steps * timestep
        self._truth_ticks = steps_between(topics.TRUTH_RATE, self.period)
        self._gripper_ticks = steps_between(topics.GRIPPER_RATE, self.period)
        self._tick = 0

    def step(self, simulator: Simulator) -> None:
        """Advance by one tick of /clock, `period` [s]."""
        for i in range(1, self._steps + 1):
            simulator.step()
            if i % self._joint_steps == 0:
                self._joints.publish(to_joint_state(simulator.joints(), simulator.cell.robot.arm.joints))
        self._clock.publish(Clock(clock=to_stamp(simulator.time)))
        self._wrench.publish(to_wrench(simulator.time, *simulator.external_wrench(), "tip"))
        for frame in simulator.mocap.due(simulator.time):
            self._markers.publish(to_markers(frame))
        self._tick += 1
        if self._tick % self._truth_ticks == 0:
            self._truth.publish(self._writer.write(simulator.truth()))
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
