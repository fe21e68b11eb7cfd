"""What stands between the packing cell's controller and a joint trajectory controller with effort interfaces.

Such a controller takes plans nearly as they are. It does not look for what no arm can follow, it does not
stop when no plan comes any more, and it refuses the hold with which a goal ends, as that is over when it
comes (docs/cells/packing/driver_mappings.md). The relay does these three.
"""

from __future__ import annotations

import numpy as np

from pack_core.joints import Desired, FeedForward, JointSample, Setpoints
from pack_core.robots.joint_properties import JointLimits
from pack_core.rotations import Array
from pack_sim.setpoint_follower import SetpointFollower

AT_ONCE = 0.0
"""Stamp of a trajectory that a joint trajectory controller begins when it comes [s]."""


class EffortRelay:
    """Passes setpoints on, and has the arm held where no more come.

    Args:
        limits: limits of the joints.
        watchdog: age at which setpoints are stale [s].
    """

    def __init__(self, limits: JointLimits, watchdog: float) -> None:
        self._follower = SetpointFollower(limits, watchdog, _Standing())
        self._is_led = False

    def accept(self, setpoints: Setpoints, time: float) -> Setpoints | None:
        """Setpoints that arrived at `time` [s], if they are to be passed on.

        Those that are over, as the hold at the end of a goal is, are not: `advance` then says where to hold.

        Raises:
            MessageError: they cannot be followed; what was passed on before stays in force.
        """
        self._follower.accept(setpoints, time)
        return setpoints if setpoints.end > time else None

    def drop(self) -> None:
        """Forget what was passed on, as when its sender died: the arm is held from the next sample on."""
        self._follower.drop()

    def advance(self, joints: JointSample) -> Setpoints | None:
        """One row at the measured positions when the arm is to be held from now on, to be begun at once."""
        self._follower.at(joints.time, joints.q, joints.v)
        was_led, self._is_led = self._is_led, not self._follower.is_holding
        if self._is_led or not was_led:
            return None
        still = np.zeros((1, len(joints.q)))
        return Setpoints(AT_ONCE, np.zeros(1), joints.q[None].copy(), still, still)


class _Standing:
    """The brake of a driver whose own controller holds the arm."""

    feed_forward: FeedForward = "tau"
    slow_down = 0.0

    def hold(self, _: float, q: Array, v: Array, *, is_late: bool) -> Desired:
        return q, np.zeros(len(q)), np.zeros(len(q))

    def check(self, setpoints: Setpoints, time: float) -> None:
        """All may be followed, as the gains are low."""

    def follow(self, setpoints: Setpoints, time: float) -> Desired:
        return setpoints.at(time)
