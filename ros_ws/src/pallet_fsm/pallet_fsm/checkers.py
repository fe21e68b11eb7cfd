"""Checks whether the measured tool pose has reached a state's target (section 8.2), and is at rest."""

from __future__ import annotations

from collections import deque

import numpy as np

from pack_core.motion.target import ReachTolerance
from pack_core.rotations import Array, Pose, angle_between
from pallet_fsm.states import Check

TOLERANCES = {Check.PRECISE: ReachTolerance(0.002, 0.5, 1), Check.TRANSIT: ReachTolerance(0.005, 1.0, 3)}


class TargetChecker:
    """Confirms that one target was reached.

    Orientations are compared by their angle: the norm of a unit error quaternion, which Eq. 5.5
    tests, is always one.

    Args:
        X_WT: target pose of the tool.
        check: which tolerance applies.
    """

    def __init__(self, X_WT: Pose, check: Check) -> None:
        self._X_WT, self._tolerance = X_WT, TOLERANCES[check]
        self._steps = 0

    def look(self, X_WT: Pose) -> bool:
        """Take a measured tool pose, and return whether the target is reached with it.

        The pose must be within the tolerance in a number of consecutive calls.
        """
        position = float(np.linalg.norm(X_WT.p - self._X_WT.p))
        angle = float(np.degrees(angle_between(X_WT.q, self._X_WT.q)))
        is_near = position <= self._tolerance.position and angle <= self._tolerance.orientation_deg
        self._steps = self._steps + 1 if is_near else 0
        return self._steps >= self._tolerance.steps


SPEED_WINDOW = 0.02
"""Least time between the two measurements that a speed is computed from [s]."""


class ToolSpeed:
    """Speed of the measured tool, over the last `SPEED_WINDOW` or since the last measurement before it.

    Attributes:
        value: the speed [m/s]; infinite before there are two measurements far enough apart in time.
    """

    def __init__(self) -> None:
        self._measured: deque[tuple[float, Array]] = deque()
        self.value = np.inf

    def look(self, time: float, p_WT: Array) -> None:
        """Take a measured position `(3,)` [m] at `time` [s]."""
        self._measured.append((time, p_WT))
        limit = time - SPEED_WINDOW + 1e-9
        while len(self._measured) > 1 and self._measured[1][0] <= limit:
            self._measured.popleft()
        first, p_first = self._measured[0]
        if first <= limit:
            self.value = float(np.linalg.norm(p_WT - p_first)) / (time - first)
