"""Judges a move: whether it is running, has arrived, is held, is stuck or was refused, and why."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pack_core.joints import JointSample
from pack_core.motion.target import MotionState, MotionStatus, MotionTarget
from pack_motion.arm.arm import MotionArm
from pack_motion.reach_progress import ReachProgress
from pack_motion.stuck import StuckDetector
from pack_motion.tracking.config import Stuck
from pack_motion.tracking.pursuit import Pursuit


class MoveMonitor:
    """Judges one move after the other.

    Args:
        arm: the arm that moves.
        config: when a move counts as stuck.

    Attributes:
        state: state of the newest target.
        progress: measured errors towards that target.
    """

    def __init__(self, arm: MotionArm, config: Stuck) -> None:
        self._arm = arm
        self._stuck = StuckDetector(config)
        self._reason, self._id = "", 0
        self._is_pursuing = False
        self.state = MotionState.IDLE
        self.progress = ReachProgress(arm)

    def begin(self, target_id: int) -> None:
        """Start to judge a target that was accepted."""
        self.progress.restart()
        self._stuck.restart()
        self.state, self._reason, self._id = MotionState.MOVING, "", target_id
        self._is_pursuing = True

    def refuse(self, target_id: int, reason: str) -> None:
        """Note a refused target; the plan that is still followed is not judged any more."""
        self.state, self._reason, self._id = MotionState.REFUSED, reason, target_id
        self._is_pursuing = False

    def stand(self) -> None:
        """Note that there is no move to judge."""
        self.state, self._is_pursuing = MotionState.IDLE, False

    def hold(self, reason: str, *, is_unfinished: bool) -> None:
        """Note that the driver holds the arm; the reason is reported if a move is unfinished."""
        self._is_pursuing = False
        if is_unfinished:
            self.state, self._reason = MotionState.HELD, reason

    def resume(self, *, is_unfinished: bool) -> None:
        """Note that the arm stands and is not held any more."""
        self.progress = ReachProgress(self._arm)
        if not is_unfinished and self.state is MotionState.HELD:
            self.state, self._reason = MotionState.IDLE, ""

    def judge(
        self, h: float, sample: JointSample, pursuit: Pursuit, target: MotionTarget,
        near: tuple[float, Sequence[str]],
    ) -> None:  # fmt: skip
        """Bring the state up to date after a step.

        Args:
            h: duration of the step [s].
            sample: the newest measurement.
            pursuit: the pursuit of the plan.
            target: the target that is pursued.
            near: smallest distance to an obstacle [m], and the names of the obstacles considered.
        """
        self.progress.measure(sample, pursuit.plan.X_WT, target.tolerance, pursuit.is_over)
        if not self._is_pursuing:
            return
        is_reached = self.progress.reached_steps >= target.tolerance.steps
        wrong = self._stuck.update(h, pursuit.rate, pursuit.is_over, is_reached, pursuit.gives_way)
        if is_reached:
            self.state, self._reason = MotionState.REACHED, ""
        elif wrong:
            self.state, self._reason = MotionState.STUCK, self._explained(wrong, *near)
        else:
            self.state = MotionState.SETTLING if pursuit.is_over else MotionState.MOVING
            is_slowed = pursuit.gives_way and pursuit.rate < 1.0
            self._reason = self._explained("gives way", *near) if is_slowed else ""

    def status(self, pursuit: Pursuit) -> MotionStatus:
        """State and progress of the move at the newest measurement."""
        progress = self.progress
        return MotionStatus(
            time=progress.time, id=self._id, state=self.state, segment=pursuit.segment,
            label=pursuit.plan.segments[pursuit.segment].label, remaining=pursuit.remaining,
            position_error=progress.position_error, orientation_error=progress.orientation_error,
            path_error=progress.path_error, reached_steps=progress.reached_steps, reason=self._reason,
            X_WT=progress.X_WT,
        )  # fmt: skip

    def _explained(self, wrong: str, distance: float, names: Sequence[str]) -> str:
        error = f"the tool is {1000 * self.progress.position_error:.0f} mm from its target"
        around = f"; the nearest of {', '.join(names)} is {1000 * distance:.0f} mm away"
        return f"{wrong}: {error}{around if np.isfinite(distance) else ''}"
