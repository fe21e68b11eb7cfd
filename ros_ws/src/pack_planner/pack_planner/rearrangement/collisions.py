"""Which blocks an action would hit, as bits: separating axes, compiled.

Bit `q` of a word row says that the footprint overlaps square `q`; touching is not overlapping.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from numba import njit

from pack_core.rotations import Array

Words = npt.NDArray[np.uint64]
BITS = 64
TOUCH = 1e-7
"""Overlaps less deep than this are touching [m]."""


def hits(footprints: Array, squares: Array) -> Words:
    """Which squares each footprint overlaps, as bits.

    Args:
        footprints: `(..., rectangles, 6)`, each the union of its rectangles.
        squares: `(Q, 6)`

    Returns:
        Words `(..., ceil(Q / 64))`.
    """
    *shape, n, _ = footprints.shape
    flat = np.ascontiguousarray(footprints).reshape(-1, n, 6)
    words = hit_words(flat, np.ascontiguousarray(squares))
    return words.reshape(*shape, words.shape[-1])


@njit(cache=True)
def hit_words(footprints: Array, squares: Array) -> Words:
    """`hits` of footprints `(F, rectangles, 6)`."""
    count = (squares.shape[0] + BITS - 1) // BITS
    words = np.zeros((footprints.shape[0], count), dtype=np.uint64)
    for f in range(footprints.shape[0]):
        for r in range(footprints.shape[1]):
            for q in range(squares.shape[0]):
                if overlap(footprints[f, r], squares[q]):
                    words[f, q // BITS] |= np.uint64(1) << np.uint64(q % BITS)
    return words


@njit(cache=True, inline="always")
def overlap(a: Array, b: Array) -> bool:
    """Two rectangles have more than their outlines in common."""
    x, y = b[0] - a[0], b[1] - a[1]
    reach = a[4] + a[5] + b[4] + b[5]
    if x * x + y * y > reach * reach:
        return False
    cosine, sine = abs(a[2] * b[2] + a[3] * b[3]), abs(a[2] * b[3] - a[3] * b[2])
    return bool(
        abs(x * a[2] + y * a[3]) + TOUCH < a[4] + b[4] * cosine + b[5] * sine
        and abs(y * a[2] - x * a[3]) + TOUCH < a[5] + b[4] * sine + b[5] * cosine
        and abs(x * b[2] + y * b[3]) + TOUCH < b[4] + a[4] * cosine + a[5] * sine
        and abs(y * b[2] - x * b[3]) + TOUCH < b[5] + a[4] * sine + a[5] * cosine
    )


@njit(cache=True, inline="always")
def is_free(footprint: Words, occupied: Words) -> bool:
    """The footprint hits none of the squares that are occupied, both `(words,)`."""
    hit = np.uint64(0)
    for w in range(occupied.shape[0]):
        hit |= footprint[w] & occupied[w]
    return bool(hit == 0)
