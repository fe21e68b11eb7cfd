"""Sets of blocks as bits, compiled."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from numba import njit

Bits = npt.NDArray[np.uint64]
MEMO_BITS = 16
"""Results about sets that are remembered, as a power of two."""


@njit(cache=True, inline="always")
def bit(i: int) -> np.uint64:
    """The set of block i."""
    return np.uint64(1) << np.uint64(i)


@njit(cache=True, inline="always")
def count_bits(bits: np.uint64) -> int:
    """Number of blocks in a set."""
    total = 0
    while bits:
        bits &= bits - np.uint64(1)  # takes the lowest block out of the set
        total += 1
    return total
