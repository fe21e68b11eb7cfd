"""What is said about a move: whether it goes on, has arrived, is held, stuck or was refused, and why."""

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
        arm: what moves.
        config: when a move counts as stuck.

    Attributes:
        state: of the newest target.
        progress: how that is being reached, as measured.
    """

    def __init__(self, arm: MotionArm, config: Stuck) -> None:
        self._arm = arm
        self._stuck = StuckDetector(config)
        self._reason, self._id = "", 0
        self._is_pursuing = False
        self.state = MotionState.IDLE
        self.progress = ReachProgress(arm)

    def begin(self, target_id: int) -> None:
        """A target was taken."""
        self.progress.restart()
        self._stuck.restart()
        self.state, self._reason, self._id = MotionState.MOVING, "", target_id
        self._is_pursuing = True

    def refuse(self, target_id: int, reason: str) -> None:
        """A target was refused; what is being followed is judged no more."""
        self.state, self._reason, self._id = MotionState.REFUSED, reason, target_id
        self._is_pursuing = False

    def stand(self) -> None:
        """There is no move to judge."""
        self.state, self._is_pursuing = MotionState.IDLE, False

    def hold(self, reason: str, *, is_unfinished: bool) -> None:
        """The driver holds the arm; where a move is left unfinished, this is why."""
        self._is_pursuing = False
        if is_unfinished:
            self.state, self._reason = MotionState.HELD, reason

    def resume(self, *, is_unfinished: bool) -> None:
        """The arm stands, and is held no more."""
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
            pursuit: of the plan.
            target: that is pursued.
            near: least distance to an obstacle [m], and the names of those that are felt.
        """
        self.progress.measure(sample, pursuit.plan.X_WT, target.tolerance, pursuit.is_over)
        if not self._is_pursuing:
            return
        is_reached = self.progress.reached_steps >= target.tolerance.steps
        wrong = self._stuck.update(h, pursuit.rate, pursuit.is_over, is_reached)
        if is_reached:
            self.state, self._reason = MotionState.REACHED, ""
        elif wrong:
            self.state, self._reason = MotionState.STUCK, self._explained(wrong, *near)
        else:
            self.state = MotionState.SETTLING if pursuit.is_over else MotionState.MOVING
            self._reason = ""

    def status(self, time: float, pursuit: Pursuit) -> MotionStatus:
        """Where the move stands at `time` [s]."""
        progress = self.progress
        return MotionStatus(
            time=time, id=self._id, state=self.state, segment=pursuit.segment,
            label=pursuit.plan.segments[pursuit.segment].label, remaining=pursuit.remaining,
            position_error=progress.position_error, orientation_error=progress.orientation_error,
            path_error=progress.path_error, reached_steps=progress.reached_steps, reason=self._reason,
            X_WT=progress.X_WT,
        )  # fmt: skip

    def _explained(self, wrong: str, distance: float, names: Sequence[str]) -> str:
        error = f"the tool is {1000 * self.progress.position_error:.0f} mm from its target"
        around = f"; the nearest of {', '.join(names)} is {1000 * distance:.0f} mm away"
        return f"{wrong}: {error}{around if np.isfinite(distance) else ''}"
