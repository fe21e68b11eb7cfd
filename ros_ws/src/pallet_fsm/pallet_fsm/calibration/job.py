"""Work with the rig as a job: it is told what is seen, and says what the cell shall do."""

from __future__ import annotations

from collections.abc import Callable
from typing import Generic

from pallet_fsm.calibration.observation import CalibrationObservation
from pallet_fsm.calibration.rig import CalibrationRig
from pallet_fsm.calibration.steps import A, CalibrationFailed, Steps
from pallet_fsm.ports import Command, StopArm


class RigJob(Generic[A]):
    """Does one piece of work with the cell, step by step; it has no clock and calls nothing outside.

    Args:
        rig: the cell.
        work: what is to be done with it.

    Attributes:
        outcome: what the work returned; None before its end, and where it failed.
        failure: why it failed, in words; empty while it did not.
        seconds: time since the first step [s].
    """

    def __init__(self, rig: CalibrationRig, work: Callable[[CalibrationRig], Steps[A]]) -> None:
        self._rig, self._work = rig, work
        self._steps: Steps[A] | None = None
        self._begin = 0.0
        self.outcome: A | None = None
        self.failure = ""
        self.seconds = 0.0
        self.is_over = False

    def step(self, seen: CalibrationObservation) -> tuple[Command, ...]:
        """Go on with the newest observation, and return what the cell shall do now."""
        if self.is_over:
            return ()
        self._rig.seen, self._rig.commands = seen, []
        if self._steps is None:
            self._steps, self._begin = self._work(self._rig), seen.time
        self.seconds = seen.time - self._begin
        try:
            next(self._steps)
        except StopIteration as end:
            self.outcome, self.is_over = end.value, True
        except CalibrationFailed as error:
            return self.halt(str(error))
        return tuple(self._rig.commands)

    def halt(self, reason: str) -> tuple[Command, ...]:
        """End the work for a reason, the arm at rest; what the gripper holds it keeps."""
        if self.is_over:
            return ()
        self.failure, self.is_over = reason, True
        return (StopArm(),)
