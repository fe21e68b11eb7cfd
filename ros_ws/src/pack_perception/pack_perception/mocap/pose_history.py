"""Positions of the recent past, for measurements that arrive late."""

from __future__ import annotations

import numpy as np

from pack_core.rotations import Array


class PoseHistory:
    """The positions `qpos` at the last `length` times.

    Args:
        length: number of times that are kept.
        nq: size of `qpos`.
    """

    def __init__(self, length: int, nq: int) -> None:
        self._times = np.full(length, -np.inf)
        self._qpos = np.zeros((length, nq))

    def add(self, time: float, qpos: Array) -> None:
        """Append the positions at `time` [s], which is later than all times before."""
        self._times[:-1], self._qpos[:-1] = self._times[1:], self._qpos[1:]
        self._times[-1], self._qpos[-1] = time, qpos

    def covers(self, time: float) -> bool:
        """Whether the history reaches back to `time` [s]."""
        return bool(np.any(np.isfinite(self._times) & (self._times <= time)))

    def at(self, time: float) -> Array:
        """Positions `(nq,)` at a time that the history covers; the newest ones for later times.

        They are interpolated linearly between two entries, so quaternions have only nearly unit length.
        """
        i = int(np.searchsorted(self._times, time, side="right"))
        if i == len(self._times):
            return np.array(self._qpos[-1])
        t0, t1 = self._times[i - 1 : i + 1]
        s = (time - t0) / (t1 - t0)
        return np.asarray((1.0 - s) * self._qpos[i - 1] + s * self._qpos[i])

    def since(self, time: float) -> Array:
        """The entries `(t, nq)` after `time`, oldest first; writing to them changes the history."""
        return self._qpos[int(np.searchsorted(self._times, time, side="right")) :]
