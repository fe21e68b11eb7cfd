"""Where a ray meets an axis-parallel rectangle."""

from __future__ import annotations

import numpy as np

from pack_core.rotations import Array


def ray_to_rectangle(origin: Array, direction: Array, lower: Array, upper: Array) -> float:
    """Length of the ray up to the open rectangle, by slabs; infinite where it misses.

    Args:
        origin: `(2,)`
        direction: unit vector `(2,)`
        lower: corner of the rectangle `(2,)`
        upper: the opposite corner `(2,)`
    """
    enter, leave = 0.0, np.inf
    for p, d, low, high in zip(origin, direction, lower, upper, strict=True):
        if d == 0.0:
            if not low < p < high:
                return np.inf
            continue
        first, second = sorted(((low - p) / d, (high - p) / d))
        enter, leave = max(enter, float(first)), min(leave, float(second))
    return enter if enter < leave else np.inf
