"""When an arm began to brake and when it stood, from what was heard of its joints."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from pack_core.rotations import Array

STILL = 0.05
"""Speed of the fastest joint below which the arm stands [rad/s]."""
REST = 0.1
"""The arm stands once it has been that slow for so long [s]."""
NEAR_TOP = 0.97
"""An arm at constant speed brakes from the last moment on at which it had this share of its highest speed."""
RISING = 0.5
"""Acceleration of the fastest joint from which its speed counts as rising [rad/s^2]."""
NEAR_PEAK = 0.9
"""An arm whose speed rises brakes from the last moment on at which it had this share of its acceleration: as
jerk is bounded, its speed goes on rising for some 50 ms, by less and less."""
SMOOTHED = 5
"""Joint states over which the acceleration is averaged."""
MEMORY = 20_000
"""Joint states that are kept: those of 40 s at 500 Hz."""


@dataclass(frozen=True)
class Stop:
    """How an arm came to rest: `nan` where it stood already, infinite where it did not come to rest.

    Attributes:
        brakes_after: when it began to brake [s].
        stands_after: when it stood [s].
    """

    brakes_after: float = float("nan")
    stands_after: float = float("nan")


class ArmRecord:
    """Speeds of the fastest joint, with their stamps and the wall clock at which they were sent."""

    def __init__(self) -> None:
        self._rows: deque[tuple[float, int, float]] = deque(maxlen=MEMORY)

    def add(self, stamp: float, sent_ns: int, speed: float) -> None:
        """A joint state: its stamp [s], when it was sent [ns of wall clock], its fastest joint [rad/s]."""
        if stamp < self.time:  # another simulator, whose time has begun anew
            self._rows.clear()
        self._rows.append((stamp, sent_ns, speed))

    @property
    def time(self) -> float:
        """Stamp of the newest joint state [s]; 0 before the first."""
        return self._rows[-1][0] if self._rows else 0.0

    @property
    def speed(self) -> float:
        """Of the fastest joint, newest [rad/s]."""
        return self._rows[-1][2] if self._rows else 0.0

    def age(self, now_ns: int) -> float:
        """Age of the newest joint state at a moment of the wall clock [s]; infinite if there is none."""
        return (now_ns - self._rows[-1][1]) * 1e-9 if self._rows else float("inf")

    def speed_at(self, time: float) -> float:
        """Of the fastest joint in the last joint state by a stamp [rad/s]; `nan` before the first."""
        return next((speed for stamp, _, speed in reversed(self._rows) if stamp <= time), float("nan"))

    def simulated(self, wall_ns: int) -> float:
        """Stamp of the last joint state that was sent by a moment of the wall clock [s]."""
        return max((stamp for stamp, sent, _ in self._rows if sent <= wall_ns), default=0.0)

    def is_at_rest(self) -> bool:
        """Whether the arm has stood for `REST`."""
        recent = [speed for stamp, _, speed in self._rows if stamp > self.time - REST]
        return bool(recent) and max(recent) < STILL

    def between(self, begin: float, end: float) -> Array:
        """Stamps and speeds `(T, 2)` [s, rad/s] of what was heard from `begin` to `end` [s]."""
        rows = [(stamp, speed) for stamp, _, speed in self._rows if begin <= stamp <= end]
        return np.array(rows).reshape(-1, 2)

    def save(self, path: Path, begin: float, end: float) -> None:
        """Write what was heard from `begin` to `end` [s] to a file, for whoever wants to look closer."""
        path.parent.mkdir(parents=True, exist_ok=True)
        header = "time [s simulated], speed of the fastest joint [rad/s]"
        np.savetxt(path, self.between(begin, end), "%.4f", ", ", header=header)

    def stop_after(self, time: float) -> Stop:
        """How the arm came to rest after a moment of simulated time [s]."""
        rows = self.between(time, float("inf"))
        return stop_of(rows[:, 0], rows[:, 1], time) if len(rows) else Stop()


def stop_of(stamps: Array, speeds: Array, time: float) -> Stop:
    """How an arm came to rest.

    Args:
        stamps: from `time` on `(T,)` [s].
        speeds: of the fastest joint `(T,)` [rad/s].
        time: of the fault, from which the stop is measured [s].
    """
    if speeds[0] < STILL and speeds.max() < STILL:
        return Stop()
    moving = np.flatnonzero(speeds >= STILL)
    # Before the arm stood for the first time: what it did later, such as going on, is not this stop.
    pauses = np.flatnonzero(np.diff(np.append(stamps[moving], stamps[-1])) > REST)
    if not pauses.size:
        return Stop(float("inf"), float("inf"))
    last = int(moving[pauses[0]])
    return Stop(_brakes_at(stamps[: last + 1], speeds[: last + 1]) - time, float(stamps[last]) - time)


def _brakes_at(stamps: Array, speeds: Array) -> float:
    """When an arm began to brake that stands at the end [s]."""
    fastest = int(np.flatnonzero(speeds >= NEAR_TOP * speeds.max())[-1])
    if fastest < SMOOTHED:
        return float(stamps[fastest])
    mean = np.ones(SMOOTHED) / SMOOTHED
    rise = np.convolve(np.gradient(speeds, stamps), mean, "same")[: fastest + 1]
    if rise.max() < RISING:
        return float(stamps[fastest])
    return float(stamps[np.flatnonzero(rise >= NEAR_PEAK * rise.max())[-1]])
