"""What the simulated blocks cell publishes, each at its rate."""

from __future__ import annotations

from rosgraph_msgs.msg import Clock

from pack_core.robots.ur10e import JOINTS
from pack_core.ros.blocks.block_messages import to_jaw_state
from pack_core.ros.cell_node import CellNode
from pack_core.ros.contracts import blocks as contracts
from pack_core.ros.contracts import motion, shared
from pack_core.ros.conversions import to_stamp
from pack_core.ros.joint_messages import to_joint_state
from pack_core.ros.scene_messages import to_scene
from pack_sim.blocks.simulator import BlocksSimulator

BLOCK = 4
"""Physics steps between two ticks of /clock."""
JAW_EVERY = 3
TRUTH_EVERY = 5


class BlocksPublisher:
    """Steps the physics in blocks and publishes what is due."""

    def __init__(self, node: CellNode) -> None:
        self._clock = node.advertise(shared.CLOCK)
        self._joints = node.advertise(motion.JOINT_STATES)
        self._jaw = node.advertise(contracts.JAW_STATE)
        self._truth = node.advertise(contracts.TRUTH)
        self._block = 0

    def step(self, simulator: BlocksSimulator, jaw_commands: int) -> None:
        """Advance by one block; the gripper has taken so many commands."""
        for _ in range(BLOCK):
            simulator.step()
        self._clock.publish(Clock(clock=to_stamp(simulator.time)))
        self._joints.publish(to_joint_state(simulator.joints(), JOINTS))
        self._block += 1
        if self._block % JAW_EVERY == 0:
            self._jaw.publish(to_jaw_state(simulator.jaw_state(), jaw_commands))
        if self._block % TRUTH_EVERY == 0:
            self._truth.publish(to_scene(simulator.truth()))
