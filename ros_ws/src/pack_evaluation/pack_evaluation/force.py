"""Low-pass filter behind which a run's peak force is taken."""

from __future__ import annotations

import numpy as np
from scipy.signal import lfilter

from pack_core.rotations import Array

FILTER_TIME = 0.005
"""Time constant of the filter [s]; unfiltered, rigid contact oscillates at the step of the physics."""


def low_pass(times: Array, values: Array) -> Array:
    """Values `(n,)` after a first-order low-pass whose initial state is the first value.

    Args:
        times: `(n,)` [s], evenly spaced.
        values: `(n,)`.
    """
    if values.size < 2:
        return values.copy()
    period = float(np.median(np.diff(times)))
    keep = np.exp(-period / FILTER_TIME)
    # y[k] = keep y[k-1] + (1 - keep) x[k]; zi makes the first output equal to the first value
    filtered, _ = lfilter([1.0 - keep], [1.0, -keep], values, zi=[keep * values[0]])
    return np.asarray(filtered)
