"""The joint trajectory controller where a simulator has its own follower of setpoints."""

from __future__ import annotations

from collections.abc import Callable

from foreign_driver.joint_trajectory_controller import JointTrajectoryController
from pack_core.joints import Desired, FeedForward, Setpoints
from pack_core.rotations import Array


class TrajectoryFollower:
    """Has a controller drive a simulated arm.

    Args:
        controller: the controller.
        after_cycle: is called after each of its cycles.
        feed_forward: what its trajectories state besides positions and velocities.
    """

    is_holding = False
    """Whether the simulator's own law shall brake: never, as this controller holds by itself."""

    def __init__(
        self, controller: JointTrajectoryController, after_cycle: Callable[[], None] = lambda: None,
        feed_forward: FeedForward = "a",
    ) -> None:  # fmt: skip
        self._controller, self._after_cycle, self.feed_forward = controller, after_cycle, feed_forward

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
