"""A simulator's node in a cell whose arm follows the node `motion` and that has a camera."""

from __future__ import annotations

import os
from abc import abstractmethod
from collections.abc import Callable, Iterable, Sequence
from typing import Any, Protocol

from rclpy.node import Node
from trajectory_msgs.msg import JointTrajectory

from pack_core.joints import JointReference
from pack_core.ros.contracts import motion
from pack_core.ros.contracts.contract import Contract
from pack_core.ros.messages.joints import from_trajectory
from pack_core.ros.run import run_node
from pack_sim.reference_follower import ReferenceFollower
from pack_sim.ros.physics_node import PhysicsNode, Service, SimulatedCell


class FollowingSimulator(SimulatedCell, Protocol):
    """A simulated cell whose driver follows joint references."""

    follower: ReferenceFollower

    def accept(self, reference: JointReference) -> None:
        """Hand a reference to the driver; raises MessageError when it is refused."""


class CameraEnd(Protocol):
    """A camera that draws in a thread of its own, as far as this node needs it."""

    def close(self) -> None:
        """End the thread."""


class MotionSimNode(PhysicsNode):
    """The node `sim` of such a cell; a subclass builds simulator and camera and then calls `follow_motion`.

    Args:
        joints: names of the arm's joints, in the order of the setpoints.
    """

    def __init__(self, joints: Sequence[str], **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self._joints = joints
        self._camera_end: CameraEnd | None = None

    @property
    @abstractmethod
    def simulator(self) -> FollowingSimulator:
        """The cell in motion."""

    def follow_motion(
        self, services: Iterable[tuple[Contract, Service]], factor: float, camera: CameraEnd
    ) -> None:
        """Take setpoints from the node `motion` and let time run.

        Args:
            services: what is served, and by whom.
            factor: simulated seconds a second of wall clock, 0 for as fast as it can.
            camera: is closed with the node.
        """
        self._camera_end = camera
        self.start(motion.SETPOINTS, "motion", services, factor)

    def accept(self, message: JointTrajectory) -> None:
        reference = from_trajectory(message, self._joints)
        with self.lock:
            self.simulator.accept(reference)

    def drop(self) -> None:
        self.simulator.follower.drop()

    def destroy_node(self) -> None:
        """Stop the physics and the camera, then the node."""
        self.stop()
        if self._camera_end is not None:
            self._camera_end.close()
        super().destroy_node()


def run_sim_with_camera(make: Callable[[], Node]) -> int:
    """As `run_node`; drawing in software leaves the other cores to the physics."""
    os.environ.setdefault("LP_NUM_THREADS", "1")  # of Mesa's llvmpipe
    return run_node(make)
