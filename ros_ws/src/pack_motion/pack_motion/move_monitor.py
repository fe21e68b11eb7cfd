"""Judges a move: whether it is running, has arrived, is held, is stuck or was refused, and why."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence

import numpy as np

from pack_core.joints import JointSample
from pack_core.motion.target import MotionState, MotionStatus, MotionTarget, ReachTolerance
from pack_core.rotations import Array, Pose, angle_between
from pack_motion.arm.arm import MotionArm
from pack_motion.reference.trajectory import JointState
from pack_motion.tracking.config import Stuck
from pack_motion.tracking.pursuit import Pursuit

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


STANDING = 0.02
"""Rate below which the reference counts as standing still; 1 is as planned."""


class StuckDetector:
    """Measures how long the reference has waited, and how long after its end the target is not reached."""

    def __init__(self, config: Stuck) -> None:
        self._config = config
        self._waited = self._settled = self._gave_way = 0.0

    def restart(self) -> None:
        """Start to count for a new move."""
        self._waited = self._settled = self._gave_way = 0.0

    def update(self, h: float, rate: float, is_over: bool, is_reached: bool, gives_way: bool = False) -> str:
        """Why the move is stuck after a further step; empty when it is not.

        Args:
            h: duration of the step [s].
            rate: rate at which the reference advances.
            is_over: whether the reference is at its end.
            is_reached: whether the tool is at its target.
            gives_way: whether it keeps the distance from somebody.
        """
        is_waiting = rate < STANDING and not is_over
        is_settling = is_over and not is_reached
        self._gave_way = self._gave_way + h if gives_way and (is_waiting or is_settling) else 0.0
        self._waited = self._waited + h if is_waiting and not gives_way else 0.0
        self._settled = self._settled + h if is_settling and not gives_way else 0.0
        if self._gave_way > self._config.giving_way:
            return f"gave way for {self._gave_way:.1f} s"
        if self._waited > self._config.waiting:
            return f"held up for {self._waited:.1f} s"
        if self._settled > self._config.settling:
            return f"not at its target {self._settled:.1f} s after the end of the move"
        return ""


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
        self._segments: deque[tuple[float, int]] = deque(maxlen=MEMORY)
        self.state = MotionState.IDLE
        self.progress = ReachProgress(arm)

    def begin(self, target_id: int) -> None:
        """Start to judge a target that was accepted."""
        self.progress.restart()
        self._stuck.restart()
        self._segments.clear()
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
        self._segments.clear()
        if not is_unfinished and self.state is MotionState.HELD:
            self.state, self._reason = MotionState.IDLE, ""

    def record(self, time: float, state: JointState, segment: int) -> None:
        """Keep what is commanded for a time [s], and the segment that it belongs to."""
        self.progress.record(time, state)
        self._segments.append((time, segment))

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
        progress, segment = self.progress, self._running(pursuit)
        return MotionStatus(
            time=progress.time, id=self._id, state=self.state, segment=segment,
            label=pursuit.plan.segments[segment].label, remaining=pursuit.remaining,
            position_error=progress.position_error, orientation_error=progress.orientation_error,
            path_error=progress.path_error, reached_steps=progress.reached_steps, reason=self._reason,
            X_WT=progress.X_WT,
        )  # fmt: skip

    def _running(self, pursuit: Pursuit) -> int:
        """Index of the segment at the newest measurement; the pursuit is ahead of it by the horizon."""
        for time, segment in reversed(self._segments):
            if time <= self.progress.time + 1e-9:
                return segment
        return self._segments[0][1] if self._segments else pursuit.segment

    def _explained(self, wrong: str, distance: float, names: Sequence[str]) -> str:
        error = f"the tool is {1000 * self.progress.position_error:.0f} mm from its target"
        around = f"; the nearest of {', '.join(names)} is {1000 * distance:.0f} mm away"
        return f"{wrong}: {error}{around if np.isfinite(distance) else ''}"
