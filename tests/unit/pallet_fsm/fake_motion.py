"""An arm without physics: moves end exactly, and stop, or are refused, on request."""

from pack_core.motion.moves import Path, Transfer
from pack_core.motion.target import MotionState, MotionStatus, MotionTarget
from pack_core.rotations import Pose
from unit.pallet_fsm.faults import Faults

TICKS = 2
"""Per segment of a move."""
HELD_TICKS = 10
LAST_LINES = ("FINAL", "GRASP")
REFUSED = "the wrist would hit box 3"
STOPS = {
    "held": (MotionState.HELD, ""),
    "lost_ways": (MotionState.REFUSED, REFUSED),
    "stuck": (MotionState.STUCK, "no progress for 1 s"),
    "stuck_at_box": (MotionState.STUCK, "no progress for 1 s"),
}
"""State and reason of the motion after each fault that stops it."""


class FakeMotion:
    """Goes through the segments of a target, `TICKS` for each.

    Args:
        faults: what shall go wrong; counted down as it happens.
    """

    def __init__(self, faults: Faults) -> None:
        self._faults = faults
        self._target: MotionTarget | None = None
        self._state, self._reason, self._ticks = MotionState.IDLE, "", 0
        self._segments: list[tuple[str, Pose]] = []

    def take(self, target: MotionTarget, *, is_holding: bool) -> None:
        self._target, self._ticks = target, 0
        if self._is_refused(is_holding):
            self._state, self._reason = MotionState.REFUSED, REFUSED
            return
        self._state, self._reason, self._segments = MotionState.MOVING, "", segments(target)

    def stop(self) -> None:
        self._segments = []
        if self._state is MotionState.MOVING:
            self._state = MotionState.REACHED

    def advance(self, *, is_holding: bool) -> tuple[str, Pose] | None:
        """Label and end of the segment that ends in this tick, if one does."""
        if self._state is MotionState.HELD:
            self._ticks += 1
            self._state = MotionState.HELD if self._ticks % HELD_TICKS else MotionState.MOVING
        if self._state is not MotionState.MOVING:
            return None
        self._ticks += 1
        if self._ticks % TICKS:
            return None
        if (fault := self._fault(is_holding)) is not None:
            setattr(self._faults, fault, getattr(self._faults, fault) - 1)
            self._state, self._reason = STOPS[fault]
            return None
        ended = self._segments.pop(0)
        if not self._segments:
            self._state = MotionState.REACHED
        return ended

    def status(self, time: float, X_WT: Pose) -> MotionStatus:
        label = self._segments[0][0] if self._segments else ""
        return MotionStatus(
            time, self._target.id if self._target else 0, self._state, 0, label, 0.0,
            0.0, 0.0, 0.0, 3, self._reason, X_WT,
        )  # fmt: skip

    def _is_refused(self, is_holding: bool) -> bool:
        faults = self._faults
        if is_holding and faults.refused_carrying:
            faults.refused_carrying -= 1
            return True
        faults.refused, had = max(0, faults.refused - 1), faults.refused
        return had > 0

    def _fault(self, is_holding: bool) -> str | None:
        """Which fault ends the present segment, if any."""
        is_last_line = not is_holding and self._segments[0][0] in LAST_LINES
        for name in STOPS:
            if getattr(self._faults, name) and (name != "stuck_at_box" or is_last_line):
                return name
        return None


def segments(target: MotionTarget) -> list[tuple[str, Pose]]:
    """Labels and ends; where a depart or a hover pose is does not matter here."""
    move = target.move
    if isinstance(move, Path):
        return [(segment.label, segment.X_WT) for segment in move.segments]
    assert isinstance(move, Transfer)
    first = move.lines[0].X_WT
    labels = ["depart", "transit"] if move.depart else ["transit"]
    return [*((label, first) for label in labels), *((line.label, line.X_WT) for line in move.lines)]
