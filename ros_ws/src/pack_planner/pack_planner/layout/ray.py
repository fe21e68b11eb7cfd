"""Where a ray meets an axis-parallel rectangle."""

from __future__ import annotations

import numpy as np

from pack_core.rotations import Array


def ray_to_rectangle(origin: Array, direction: Array, lower: Array, upper: Array) -> float:
    """Length of a ray up to where it enters the open rectangle; infinite where it misses.

    The slab method: for each axis the ray is between the two edges from one length to another, and it is in
    the rectangle where these intervals overlap.

    Args:
        origin: start of the ray `(2,)`.
        direction: unit vector along the ray `(2,)`.
        lower: corner of the rectangle with the smallest coordinates `(2,)`.
        upper: the opposite corner `(2,)`.
    """
    enter, leave = 0.0, np.inf
    for p, d, low, high in zip(origin, direction, lower, upper, strict=True):
        if d == 0.0:  # parallel to the slab: either always inside it or never
            if not low < p < high:
                return np.inf
            continue
        first, second = sorted(((low - p) / d, (high - p) / d))
        enter, leave = max(enter, float(first)), min(leave, float(second))
    return enter if enter < leave else np.inf
