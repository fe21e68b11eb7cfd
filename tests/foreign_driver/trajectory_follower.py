"""The joint trajectory controller where a simulator has its own follower of setpoints."""

from __future__ import annotations

from collections.abc import Callable

from foreign_driver.joint_trajectory_controller import JointTrajectoryController
from pack_core.joints import Desired, Setpoints
from pack_core.rotations import Array


class TrajectoryFollower:
    """Has a controller drive a simulated arm.

    Args:
        controller: the controller.
        after_cycle: is called after each of its cycles.
    """

    feed_forward = "a"

    def __init__(
        self, controller: JointTrajectoryController, after_cycle: Callable[[], None] = lambda: None
    ) -> None:
        self._controller, self._after_cycle = controller, after_cycle

    def at(self, time: float, q: Array, v: Array) -> Desired:
        """What the joints shall do now."""
        desired = self._controller.update(time, q, v)
        self._after_cycle()
        return desired

    def accept(self, setpoints: Setpoints, time: float) -> None:
        """Setpoints are nothing to a driver of trajectories."""

    def drop(self) -> None:
        """Brake, and give up what is followed."""
        self._controller.stop()
