"""The external force over a goal: its mean, its peak, and the filtered value that the force stop judges."""

from __future__ import annotations

import numpy as np

from pack_core.packing.topics import WRENCH_RATE
from pack_core.rotations import Array

FILTER_TIME = 0.005
"""Time constant of the filter before the force stop [s]: as slow as a robot's own estimate of the force."""
_PERIOD = 1.0 / WRENCH_RATE
"""Time between two samples of the force [s]."""
GAIN = _PERIOD / (_PERIOD + FILTER_TIME)
"""Share of a new sample in y[k] = (1 - GAIN) y[k-1] + GAIN x[k], a first-order low-pass (backward Euler)."""


class ForceRecord:
    """Magnitudes of the external force [N], at the rate of /wrench."""

    def __init__(self) -> None:
        self._forces: list[float] = []
        self._filtered = 0.0

    def note(self, forces: Array) -> float:
        """Note new forces `(n, 3)` [N]; the largest magnitude after the filter [N], 0 without any.

        The filter keeps one noisy sample from ending a goal.
        """
        samples, peak = np.linalg.norm(forces, axis=1).tolist(), 0.0
        self._forces.extend(samples)
        for force in samples:  # scipy.signal.lfilter would take the node a second to import
            self._filtered += GAIN * (force - self._filtered)
            peak = max(peak, self._filtered)
        return peak

    @property
    def mean(self) -> float:
        """Mean of all samples [N]; 0 without any."""
        return float(np.mean(self._forces or [0.0]))

    @property
    def peak(self) -> float:
        """The largest sample [N]; 0 without any."""
        return max(self._forces, default=0.0)
