"""The contact force: the low-pass behind which its peak is taken, and how often it jumps."""

from __future__ import annotations

import numpy as np

from pack_core.packing.topics import WRENCH_RATE
from pack_core.rotations import Array

FILTER_TIME = 0.005
"""Time constant of the filter [s]; unfiltered, rigid contact oscillates at the step of the physics."""
CONTACT = 1.0
"""A force above this is contact [N]."""
JUMP = 5.0
"""A change of the force above this is a jump [N]."""
LAG = 2
"""A sample is compared with the one this many samples of `/wrench` before: 8 ms at 250 Hz."""


def low_pass(times: Array, values: Array) -> Array:
    """Values `(n,)` after a first-order low-pass whose initial state is the first value.

    Args:
        times: `(n,)` [s], evenly spaced.
        values: `(n,)`.
    """
    if values.size < 2:
        return values.copy()
    from scipy.signal import lfilter  # a second, which only evaluation takes

    period = float(np.median(np.diff(times)))
    keep = np.exp(-period / FILTER_TIME)
    # y[k] = keep y[k-1] + (1 - keep) x[k]; zi makes the first output equal to the first value
    filtered, _ = lfilter([1.0 - keep], [1.0, -keep], values, zi=[keep * values[0]])
    return np.asarray(filtered)


def chatter(times: Array, force: Array) -> float:
    """Share of the samples in contact whose force differs by more than 5 N from the one 8 ms before.

    The force is the magnitude that the force plot shows, so a force that only turns does not chatter. Samples
    are taken at the rate of `/wrench`, whatever the rate of what is given: a recording has them at 250 Hz, a
    run in lockstep at every step of the physics.

    Args:
        times: `(n,)` [s], rising.
        force: magnitudes `(n,)` [N].

    Returns:
        The share from 0 to 1; NaN if no sample is in contact or none has another 8 ms before it.
    """
    if not times.size:
        return np.nan
    slots = (times - times[0]) * WRENCH_RATE
    nearest = np.round(slots).astype(int)
    # at 1 kHz three of four samples lie a quarter of a period or more from the next sample of /wrench
    is_sample = np.abs(slots - nearest) < 0.2
    # a slot stays NaN where a message was lost
    series = np.full(nearest[-1] + 1, np.nan)
    series[nearest[is_sample]] = force[is_sample]
    now, before = series[LAG:], series[:-LAG]
    is_pair = (now > CONTACT) & np.isfinite(before)
    return float(np.mean(np.abs(now - before)[is_pair] > JUMP)) if is_pair.any() else np.nan
