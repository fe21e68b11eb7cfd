"""What the simulated driver and its sensors publish, each at its rate."""

from __future__ import annotations

from pack_interfaces.msg import GripperState
from rosgraph_msgs.msg import Clock

from pack_core.robots import panda
from pack_core.ros.cell_node import CellNode
from pack_core.ros.contracts import packing as contracts
from pack_core.ros.contracts import shared
from pack_core.ros.conversions import to_stamp, to_wrench
from pack_core.ros.joint_messages import to_joint_state
from pack_core.ros.packing.marker_messages import to_markers
from pack_core.ros.scene_messages import to_scene
from pack_sim.packing.simulator import Simulator

BLOCK = 4
"""Physics steps between two ticks of /clock."""
TRUTH_EVERY = 2
GRIPPER_EVERY = 5


class SensorPublisher:
    """Steps the physics in blocks and publishes what is due."""

    def __init__(self, node: CellNode) -> None:
        self._clock = node.advertise(shared.CLOCK)
        self._joints = node.advertise(contracts.JOINT_STATES)
        self._wrench = node.advertise(contracts.WRENCH)
        self._markers = node.advertise(contracts.MARKERS)
        self._truth = node.advertise(contracts.TRUTH)
        self._gripper = node.advertise(contracts.GRIPPER_STATE)
        self._block = 0

    def step(self, simulator: Simulator) -> None:
        """Advance by one block."""
        for i in range(BLOCK):
            simulator.step()
            if i % 2:
                self._joints.publish(to_joint_state(simulator.joints(), panda.JOINTS))
        self._clock.publish(Clock(clock=to_stamp(simulator.time)))
        self._wrench.publish(to_wrench(simulator.time, *simulator.external_wrench(), "tip"))
        for frame in simulator.mocap.due(simulator.time):
            self._markers.publish(to_markers(frame))
        self._block += 1
        if self._block % TRUTH_EVERY == 0:
            self._truth.publish(to_scene(simulator.truth()))
        if self._block % GRIPPER_EVERY == 0:
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
