"""Detects that a move makes no progress."""

from __future__ import annotations

from pack_motion.tracking.config import Stuck

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
            gives_way: whether an obstacle that moves is in the way.
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
