"""A move of the arm, from its target to where it ends, by the statuses of the motion controller."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from pack_core.motion.target import MotionState, MotionStatus
from pack_core.tasks.steps import Clock, Steps

ENDED = (MotionState.REACHED, MotionState.STUCK, MotionState.REFUSED)


class MoveFollower:
    """Numbers the targets of a task, and tells where the newest of them stands.

    Args:
        answer_time: longest time until the motion takes a target up or refuses it [s].
        longest: longest time until a target is reached [s].

    Attributes:
        number: of the newest target; 0 before the first.
    """

    def __init__(self, answer_time: float, longest: float = float("inf")) -> None:
        self._answer_time, self._longest = answer_time, longest
        self._sent, self._is_taken_up = 0.0, False
        self.number = 0

    def begin(self, newest: MotionStatus | None, time: float) -> int:
        """The number of a target that is sent at `time` [s].

        Numbers go on from those of earlier tasks, whose last status may still be the newest.
        """
        self.number = max(self.number, 0 if newest is None else newest.id) + 1
        self._sent, self._is_taken_up = time, False
        return self.number

    def stands(self, newest: MotionStatus, time: float) -> MotionStatus | None:
        """Where the target stands at `time` [s]; None before the motion has taken it up.

        It is stuck also where it was interrupted and there is no way on, and where it takes too long.
        """
        if newest.id != self.number:
            is_late = time > self._sent + self._answer_time
            return _stuck(newest, "the motion does not answer") if is_late else None
        if newest.state is MotionState.REFUSED:
            # Refused after it was taken up: the rest of the move was planned anew after an interruption.
            reason = f"interrupted, and no way on: {newest.reason}"
            return _stuck(newest, reason) if self._is_taken_up else newest
        self._is_taken_up = True
        if newest.state not in ENDED and time > self._sent + self._longest:
            return _stuck(newest, f"the move takes too long: not there after {self._longest:.0f} s")
        return newest


def follow(
    follower: MoveFollower, newest: Callable[[], MotionStatus | None], clock: Clock
) -> Steps[MotionStatus]:
    """Wait until the target that was sent last has ended; the status that says how.

    Args:
        follower: has numbered the target.
        newest: the newest status of the motion; None before the first.
        clock: the present time [s].
    """
    while True:
        status = newest()
        move = None if status is None else follower.stands(status, clock())
        if move is not None and move.state in ENDED:
            return move
        yield


def _stuck(status: MotionStatus, reason: str) -> MotionStatus:
    return replace(status, state=MotionState.STUCK, reason=reason)
