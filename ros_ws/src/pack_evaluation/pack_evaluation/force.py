"""The force that a run is judged by: the load on the cup, and its peak once chatter is filtered out."""

from __future__ import annotations

import numpy as np
from scipy.signal import lfilter

from pack_core.rotations import Array

FILTER_TIME = 0.005
"""Time constant of the low-pass that peaks are taken behind [s]: rigid contact rings at the physics' step."""


def low_pass(times: Array, values: Array) -> Array:
    """Values `(n,)` behind a first-order low-pass that starts at the first of them.

    Args:
        times: `(n,)` [s], evenly spaced.
        values: `(n,)`.
    """
    if values.size < 2:
        return values.copy()
    period = float(np.median(np.diff(times)))
    keep = np.exp(-period / FILTER_TIME)
    filtered, _ = lfilter([1.0 - keep], [1.0, -keep], values, zi=[keep * values[0]])
    return np.asarray(filtered)
