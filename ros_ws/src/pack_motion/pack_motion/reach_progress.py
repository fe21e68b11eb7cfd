"""Measured errors of the tool towards its target and its commanded path."""

from __future__ import annotations

from collections import deque

import numpy as np

from pack_core.joints import JointSample
from pack_core.motion.target import ReachTolerance
from pack_core.rotations import Array, Pose, angle_between
from pack_motion.arm.arm import MotionArm
from pack_motion.reference.trajectory import JointState

MEMORY = 64
"""Number of commanded states that are kept: setpoints are ahead of the measurements they belong to."""


class ReachProgress:
    """Compares the measured tool pose with the commanded one and with the goal.

    Attributes:
        time: of the newest measurement [s]; 0 before the first.
        X_WT: the tool in it.
    """

    def __init__(self, arm: MotionArm) -> None:
        self._arm = arm
        self._commanded: deque[tuple[float, JointState]] = deque(maxlen=MEMORY)
        self.time, self.X_WT = 0.0, Pose(np.zeros(3))
        self.position_error = self.orientation_error = self.path_error = np.inf
        self.reached_steps = 0

    def restart(self) -> None:
        """Start to count for a new target."""
        self.reached_steps = 0

    def record(self, time: float, state: JointState) -> None:
        """Keep the commanded state for a time [s]."""
        self._commanded.append((time, state))

    def measure(self, sample: JointSample, X_WG: Pose, tolerance: ReachTolerance, is_over: bool) -> None:
        """Take a measurement; steps count as reached only where the reference `is_over`."""
        self.see(sample, X_WG)
        p_commanded = self._arm.chain.forward_matrix(self._told(sample))[1]
        self.path_error = float(np.linalg.norm(self.X_WT.p - p_commanded))
        is_there = (
            is_over
            and self.position_error <= tolerance.position
            and self.orientation_error <= np.deg2rad(tolerance.orientation_deg)
        )
        self.reached_steps = self.reached_steps + 1 if is_there else 0

    def see(self, sample: JointSample, X_WG: Pose) -> None:
        """Update the tool pose and its error to the goal X_WG."""
        self.time, self.X_WT = sample.time, self._arm.chain.forward(sample.q)
        self.position_error = float(np.linalg.norm(self.X_WT.p - X_WG.p))
        self.orientation_error = float(angle_between(self.X_WT.q, X_WG.q))

    def _told(self, sample: JointSample) -> Array:
        """Commanded joint positions `(n,)` [rad] at the time of the measurement."""
        for time, state in reversed(self._commanded):
            if time <= sample.time + 1e-9:
                ahead = sample.time - time
                return np.asarray(state.q + ahead * (state.v + 0.5 * ahead * state.a))
        return self._commanded[0][1].q if self._commanded else sample.q
