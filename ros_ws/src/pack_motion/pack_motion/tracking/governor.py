"""Lets the reference wait while the tool is held up."""

from __future__ import annotations

from pack_motion.tracking.config import Governor


class RateGovernor:
    """The rate at which the reference goes on: 1 as planned, 0 standing still."""

    def __init__(self, config: Governor) -> None:
        self._config = config
        self.rate = 1.0

    def update(self, deviation: float, h: float) -> float:
        """The rate after a step of `h` [s], the tool being `deviation` [m] off the reference."""
        c = self._config
        wished = min(max((c.far - deviation) / (c.far - c.near), 0.0), 1.0)
        step = h / c.time
        self.rate += min(max(wished - self.rate, -step), step)
        return self.rate
