"""What the simulated blocks cell publishes: its state, each topic at its rate, and pictures."""

from __future__ import annotations

from collections.abc import Mapping

from pack_core import topics as shared_topics
from pack_core.blocks import topics
from pack_core.blocks.cell import BlocksCell
from pack_core.blocks.problem import BlockSizes
from pack_core.camera import Picture
from pack_core.robots.ur10e import JOINTS
from pack_core.ros.contracts import blocks as contracts
from pack_core.ros.contracts import motion, shared
from pack_core.ros.messages.blocks import to_finger_state
from pack_core.ros.messages.camera import to_camera_info, to_image
from pack_core.ros.messages.serialized import ClockWriter, JointStateWriter, SceneWriter
from pack_core.ros.node import CellNode
from pack_core.rotations import Array
from pack_core.topics import steps_between
from pack_sim.blocks.overhead_camera import OverheadCamera
from pack_sim.blocks.simulator import BlocksSimulator
from pack_sim.camera_thread import CameraThread


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


FRAME = "overhead_camera"


class CameraPublisher:
    """Publishes each picture with the intrinsics of the camera.

    Args:
        node: that publishes.
        cell: whose camera it is.
        timestep: of the physics [s].
        shadows: draw them.
    """

    def __init__(self, node: CellNode, cell: BlocksCell, timestep: float, *, shadows: bool) -> None:
        self._node, self._cell = node, cell
        self._timestep, self._shadows = timestep, shadows
        self._image = node.advertise(contracts.IMAGE)
        self._info = node.advertise(contracts.CAMERA_INFO)
        self._thread: CameraThread[Array] | None = None
        self._error = ""

    def open(self, tags: Mapping[str, int], sizes: BlockSizes) -> None:
        """Look at a table with these blocks; the number of each one's tag, and its size, by its id."""
        self.close()
        self._report("")
        camera = OverheadCamera(self._cell, tags, self._timestep, shadows=self._shadows, sizes=sizes)
        self._thread = CameraThread(camera, self._publish, self._report)

    def expose(self, time: float, snapshot: Array) -> str:
        """Have a picture taken; why there is none, empty otherwise."""
        if self._thread is not None and self._thread.expose(time, snapshot):
            return ""
        return self._error or "the last picture is still being made"

    def close(self) -> None:
        """Take no more pictures."""
        if self._thread is not None:
            self._thread.close()
            self._thread = None

    def _publish(self, time: float, picture: Picture) -> None:
        self._info.publish(to_camera_info(time, self._cell.camera.pinhole, FRAME))
        self._image.publish(to_image(time, picture, FRAME))

    def _report(self, error: str) -> None:
        """Tell why there are no pictures; empty: there are."""
        self._error = error
        if error:
            self._node.health.faults["camera"] = error
            self._node.get_logger().error(error)
        else:
            self._node.health.faults.pop("camera", None)
