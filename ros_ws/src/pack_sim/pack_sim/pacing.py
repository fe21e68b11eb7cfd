"""Pacing of a physics thread against the wall clock."""

from __future__ import annotations

import time

CATCH_UP = 0.05
"""A larger delay against the wall clock is not made up for [s of wall clock]."""
BURST = 0.012
"""Longest simulated time that is made up for at once [s]: controllers must keep up with the burst."""


class Pacer:
    """Computes how long to wait so that simulated time runs `factor` times as fast as the wall clock.

    Args:
        factor: 1 for real time, 0 for as fast as possible.
    """

    def __init__(self, factor: float) -> None:
        self._factor = factor
        self._next = time.perf_counter()
        self._mark = (time.perf_counter(), 0.0)
        self._simulated = 0.0

    @property
    def is_free(self) -> bool:
        """Whether simulated time runs as fast as it can."""
        return self._factor <= 0.0

    def change_factor(self, factor: float) -> None:
        """Run at another pace from now on; any thread may call it."""
        self._factor = factor
        self._next = time.perf_counter()

    def delay(self, simulated: float) -> float:
        """How long to wait [s] after a block of `simulated` seconds."""
        factor = self._factor  # another thread may change it meanwhile
        self._simulated += simulated
        if factor <= 0.0:
            return 0.0
        now = time.perf_counter()
        late = min(CATCH_UP, BURST / factor)
        self._next = max(self._next + simulated / factor, now - late)
        return max(0.0, self._next - now)

    def skip(self) -> None:
        """Begin anew: while simulated time stood still on purpose, the wall clock went on."""
        self._next = now = time.perf_counter()
        self._mark = (now, self._simulated)

    def achieved(self) -> float:
        """Real-time factor since the last call: simulated seconds per second of wall clock."""
        (wall, simulated), now = self._mark, time.perf_counter()
        self._mark = (now, self._simulated)
        return (self._simulated - simulated) / max(now - wall, 1e-9)
