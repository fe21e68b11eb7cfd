"""What the simulated blocks cell publishes: its state, each topic at its rate."""

from __future__ import annotations

from pack_core import topics as shared_topics
from pack_core.blocks import topics
from pack_core.robots.ur10e import JOINTS
from pack_core.ros.contracts import blocks as contracts
from pack_core.ros.contracts import motion, shared
from pack_core.ros.messages.blocks import to_finger_state
from pack_core.ros.messages.serialized import ClockWriter, JointStateWriter, SceneWriter
from pack_core.ros.node import CellNode
from pack_core.topics import steps_between
from pack_sim.blocks.simulator import BlocksSimulator


class BlocksPublisher:
    """Steps the physics from one tick to the next and publishes what is due.

    Args:
        node: that publishes.
        timestep: of the physics [s].
    """

    def __init__(self, node: CellNode, timestep: float) -> None:
        self._clock, self._clock_writer = node.advertise(shared.CLOCK), ClockWriter()
        self._joints, self._joint_writer = node.advertise(motion.JOINT_STATES), JointStateWriter(JOINTS)
        self._fingers = node.advertise(contracts.JAW_STATE)
        self._truth, self._truth_writer = node.advertise(contracts.TRUTH), SceneWriter()
        self._steps = steps_between(shared_topics.TICK_RATE, timestep)
        self.period = self._steps * timestep
        self._finger_ticks = steps_between(topics.JAW_RATE, self.period)
        self._clock_ticks = steps_between(shared_topics.CLOCK_RATE, self.period)
        self._truth_ticks = steps_between(topics.TRUTH_RATE, self.period)
        self._tick = 0

    def step(self, simulator: BlocksSimulator, finger_commands: int) -> None:
        """Advance by one tick, `period` [s]; the gripper has taken so many commands."""
        for _ in range(self._steps):
            simulator.step()
        self._joints.publish(self._joint_writer.write(simulator.joints()))
        self._tick += 1
        if self._tick % self._clock_ticks == 0:
            self._clock.publish(self._clock_writer.write(simulator.time))
        if self._tick % self._finger_ticks == 0:
            self._fingers.publish(to_finger_state(simulator.finger_state(), finger_commands))
        if self._tick % self._truth_ticks == 0:
            self._truth.publish(self._truth_writer.write(simulator.truth()))
