"""Poses of rigid bodies from their visible markers: least squares on SE(3).

Points alone are Kabsch's problem; points and directions are Wahba's. Where the markers do not match the body,
one or two of them may be false or confused with others: they are left out if there is exactly one way to
leave out so few and the rest matches.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from enum import Enum
from itertools import combinations
from typing import Any

import numba
import numpy as np
import numpy.typing as npt
from pydantic import Field, PositiveFloat

from pack_core.config import Config
from pack_core.rotations import Array

Mask = npt.NDArray[np.bool_]
MOST_SWEEPS = 30
"""Jacobi's method needs five or six for three columns; the bound is for what is not finite."""
PRECISION = 1e-15
"""Columns count as orthogonal below this cosine, and as nothing below this share of another's length."""
TINY = 1e-300
"""Guards divisions by a length."""


@dataclass(frozen=True)
class Alignment:
    """Least-squares poses of k bodies B.

    Attributes:
        p_WB: origins `(k, 3)` [m].
        q_WB: orientations `(k, 4)`, wxyz.
        spread: rms distances `(k,)` [m] of the markers from the line that fits them best.
        residual: rms distances `(k,)` [m] of the markers from where the poses put them.
    """

    p_WB: Array
    q_WB: Array
    spread: Array
    residual: Array


def align(p_BM: Array, p_WM: Array, visible: Mask, pulls: Array | float = 0.0) -> Alignment:
    """Align bodies with their markers: Kabsch's solution, compiled, and never a reflection (Umeyama).

    Args:
        p_BM: where the m markers are on each of the k bodies `(k, m, 3)` [m].
        p_WM: where they were measured `(k, m, 3)` [m].
        visible: which of them were measured `(k, m)`.
        pulls: outer products `v_W v_B^T` `(k, 3, 3)` [m^2] of directions that are to agree as well, their
            lengths being their weights.
    """
    sums = np.zeros((len(p_BM), 3, 3)) + pulls
    return Alignment(*_aligned(_writable(p_BM), _writable(p_WM), _writable(visible), sums))


def _writable(array: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """The array, or a copy of a view that may not be written to, which what is compiled would refuse."""
    return array if array.flags.writeable else array.copy()


# Loops over three components instead of array expressions: numba compiles them in a tenth of the time.


@numba.njit("f8(f8[:, ::1], i8, i8)", cache=True)
def _dot(A: Array, i: int, j: int) -> float:
    """Scalar product of two columns of A `(3, 3)`."""
    return float(A[0, i] * A[0, j] + A[1, i] * A[1, j] + A[2, i] * A[2, j])


@numba.njit("void(f8[:, ::1], f8[:, ::1])", cache=True)
def _decompose(A: Array, V: Array) -> None:
    """Make the columns of A `(3, 3)` orthogonal by rotations, which V `(3, 3)` gathers; both in place.

    That is the singular value decomposition A V = U S (one-sided Jacobi, Hestenes 1958).
    """
    for _ in range(MOST_SWEEPS):
        is_orthogonal = True
        for i in range(2):
            for j in range(i + 1, 3):
                dot, squares_i, squares_j = _dot(A, i, j), _dot(A, i, i), _dot(A, j, j)
                if abs(dot) <= PRECISION * math.sqrt(squares_i * squares_j):
                    continue
                is_orthogonal = False
                half = (squares_j - squares_i) / (2.0 * dot)
                tangent = math.copysign(1.0, half) / (abs(half) + math.sqrt(1.0 + half * half))
                cosine = 1.0 / math.sqrt(1.0 + tangent * tangent)
                for k in range(3):
                    x, y, v, w = A[k, i], A[k, j], V[k, i], V[k, j]
                    A[k, i], A[k, j] = cosine * (x - tangent * y), cosine * (y + tangent * x)
                    V[k, i], V[k, j] = cosine * (v - tangent * w), cosine * (w + tangent * v)
        if is_orthogonal:
            return


@numba.njit("void(f8[:, ::1])", cache=True)
def _set_across(U: Array) -> None:
    """Set the second column of U `(3, 3)` to a unit vector across the first, which is set if it is zero."""
    if _dot(U, 0, 0) < 0.5:
        U[0, 0] = 1.0
    k = 0
    for m in (1, 2):
        if abs(U[m, 0]) < abs(U[k, 0]):
            k = m
    for m in range(3):
        U[m, 1] = (1.0 if m == k else 0.0) - U[k, 0] * U[m, 0]
    length = math.sqrt(_dot(U, 1, 1))
    for m in range(3):
        U[m, 1] /= length


@numba.njit("f8(f8[:, ::1], f8[:, ::1])", cache=True)
def _rotate_onto(H: Array, R: Array) -> float:
    """Set R to the rotation `(3, 3)` that maximises trace(R^T H), and return the second singular value of H.

    It is U V^T. Of both U and V the third column is the cross product of the others, so that it is no
    reflection, whatever H is.
    """
    A, V = H.copy(), np.eye(3)
    _decompose(A, V)
    first, second, third = 0, 1, 2
    if _dot(A, first, first) < _dot(A, second, second):
        first, second = second, first
    if _dot(A, second, second) < _dot(A, third, third):
        second, third = third, second
    if _dot(A, first, first) < _dot(A, second, second):
        first, second = second, first
    longest, next_to_it = math.sqrt(_dot(A, first, first)), math.sqrt(_dot(A, second, second))
    U, W = np.zeros((3, 3)), np.zeros((3, 3))
    for k in range(3):
        U[k, 0], U[k, 1] = A[k, first] / max(longest, TINY), A[k, second] / max(next_to_it, TINY)
        W[k, 0], W[k, 1] = V[k, first], V[k, second]
    if next_to_it <= PRECISION * longest:  # markers on a line, or none: any turn about it does
        _set_across(U)
    for k in range(3):
        m, n = (k + 1) % 3, (k + 2) % 3
        U[k, 2] = U[m, 0] * U[n, 1] - U[n, 0] * U[m, 1]
        W[k, 2] = W[m, 0] * W[n, 1] - W[n, 0] * W[m, 1]
    for k in range(3):
        for m in range(3):
            R[k, m] = U[k, 0] * W[m, 0] + U[k, 1] * W[m, 1] + U[k, 2] * W[m, 2]
    return next_to_it


@numba.njit("void(f8[:, ::1], f8[:])", cache=True)
def _set_quaternion(R: Array, q: Array) -> None:
    """Set q to the quaternion wxyz of a rotation, by the largest of its components."""
    trace = R[0, 0] + R[1, 1] + R[2, 2]
    i = 0
    for m in (1, 2):
        if R[m, m] > R[i, i]:
            i = m
    j, k = (i + 1) % 3, (i + 2) % 3
    if trace > R[i, i]:
        q[0], q[1 + i] = 1.0 + trace, R[k, j] - R[j, k]
        q[1 + j], q[1 + k] = R[i, k] - R[k, i], R[j, i] - R[i, j]
    else:
        q[0], q[1 + i] = R[k, j] - R[j, k], 1.0 + 2.0 * R[i, i] - trace
        q[1 + j], q[1 + k] = R[i, j] + R[j, i], R[i, k] + R[k, i]
    length = math.sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3])
    for m in range(4):
        q[m] /= length


@numba.njit("i8(f8[:, :], f8[:, :], b1[:], f8[:, ::1], f8[:, ::1])", cache=True)
def _gather(p_BM: Array, p_WM: Array, visible: Mask, centres: Array, H: Array) -> int:
    """Set the visible markers' centres in B and in W `(2, 3)`, add their moments to H, and count them.

    The moments are the sum of w_W w_B^T, where w leads from the centre to a marker.
    """
    count = 0
    centres[:] = 0.0
    for j in range(len(visible)):
        if visible[j]:
            count += 1
            for m in range(3):
                centres[0, m] += p_BM[j, m]
                centres[1, m] += p_WM[j, m]
    centres /= max(count, 1)
    for j in range(len(visible)):
        if visible[j]:
            for m in range(3):
                for n in range(3):
                    H[m, n] += (p_WM[j, m] - centres[1, m]) * (p_BM[j, n] - centres[0, n])
    return count


@numba.njit("f8(f8[:, :], f8[:, :], b1[:], f8[:, ::1], f8[:, ::1])", cache=True)
def _misses(p_BM: Array, p_WM: Array, visible: Mask, centres: Array, R: Array) -> float:
    """Sum of the squared distances of the visible markers from where a pose puts them."""
    squares = 0.0
    for j in range(len(visible)):
        if visible[j]:
            for m in range(3):
                miss = centres[1, m] - p_WM[j, m]
                for n in range(3):
                    miss += R[m, n] * (p_BM[j, n] - centres[0, n])
                squares += miss * miss
    return squares


@numba.njit(
    "Tuple((f8[:, ::1], f8[:, ::1], f8[::1], f8[::1]))(f8[:, :, :], f8[:, :, :], b1[:, :], f8[:, :, ::1])",
    cache=True,
)
def _aligned(p_BM: Array, p_WM: Array, visible: Mask, pulls: Array) -> tuple[Array, Array, Array, Array]:
    """The fields of an `Alignment`; the pulls are overwritten."""
    bodies = len(visible)
    p_WB, q_WB = np.empty((bodies, 3)), np.empty((bodies, 4))
    spread, residual = np.empty(bodies), np.empty(bodies)
    R, centres = np.empty((3, 3)), np.empty((2, 3))
    for i in range(bodies):
        count = max(_gather(p_BM[i], p_WM[i], visible[i], centres, pulls[i]), 1)
        # singular values are sums of squares along the principal directions: the second measures the spread
        # of the markers away from the line along the first
        spread[i] = math.sqrt(_rotate_onto(pulls[i], R) / count)
        residual[i] = math.sqrt(_misses(p_BM[i], p_WM[i], visible[i], centres, R) / count)
        for m in range(3):
            p_WB[i, m] = centres[1, m]
            for n in range(3):
                p_WB[i, m] -= R[m, n] * centres[0, n]
        _set_quaternion(R, q_WB[i])
    return p_WB, q_WB, spread, residual


AGREEING = 4
"""Markers that must match the body where others are left out: three can do so turned over."""


class FitConfig(Config):
    """Conditions under which a fit is accepted."""

    min_markers: int = Field(default=3, ge=3, description="visible markers")
    min_spread: PositiveFloat = Field(
        default=0.008, description="rms distance of the markers from the line that fits them best [m]"
    )
    max_residual: PositiveFloat = Field(default=0.003, description="rms distance of a marker [m]")
    max_left_out: int = Field(default=2, ge=0, description="markers that may be false")


class FitRefusal(Enum):
    """Reasons to refuse a fit."""

    TOO_FEW = "too few markers"
    COLLINEAR = "markers on a line"
    RESIDUAL = "markers do not match the object"
    NOT_STANDING = "markers not as high as those of the standing object"


@dataclass(frozen=True)
class Fits:
    """Fitted poses of k bodies B; refused rows must not be used.

    Attributes:
        p_WB: origins `(k, 3)` [m].
        q_WB: orientations `(k, 4)`, wxyz.
        residual: rms distance `(k,)` [m] of the markers from where the pose puts them.
        refusals: why a fit was refused; None where it was accepted.
        left_out: number of markers that were not used because they do not match `(k,)`.
    """

    p_WB: Array
    q_WB: Array
    residual: Array
    refusals: tuple[FitRefusal | None, ...]
    left_out: npt.NDArray[np.int_]


def fit_rigid_bodies(p_BM: Array, p_WM: Array, visible: Mask, config: FitConfig) -> Fits:
    """Fit poses of k bodies to their markers by least squares.

    Args:
        p_BM: where the m markers are on each of the k bodies `(k, m, 3)` [m].
        p_WM: where they were measured `(k, m, 3)` [m].
        visible: which of them were measured `(k, m)`.
        config: conditions under which a fit is accepted.
    """
    whole = _fit(p_BM, p_WM, visible, config)
    used = visible.copy()
    for row in np.flatnonzero(whole.residual > config.max_residual):
        used[row] = _matching(p_BM[row], p_WM[row], visible[row], config)
    left_out = visible.sum(axis=1) - used.sum(axis=1)
    fits = _fit(p_BM, p_WM, used, config) if left_out.any() else whole
    return replace(fits, left_out=left_out)


def _matching(p_BM: Array, p_WM: Array, visible: Mask, config: FitConfig) -> Mask:
    """The visible markers of one body `(m,)` without those that do not match; all where that is not clear."""
    there = np.flatnonzero(visible)
    for count in range(1, min(config.max_left_out, len(there) - AGREEING) + 1):
        used = np.array([visible & ~np.isin(np.arange(len(visible)), some)
                         for some in combinations(there, count)])  # fmt: skip
        n = len(used)
        fits = _fit(np.repeat(p_BM[None], n, axis=0), np.repeat(p_WM[None], n, axis=0), used, config)
        matching = [row for row, refusal in enumerate(fits.refusals) if refusal is None]
        if matching:
            return used[matching[0]] if len(matching) == 1 else visible
    return visible


def _fit(p_BM: Array, p_WM: Array, visible: Mask, config: FitConfig) -> Fits:
    """Poses from all visible markers."""
    found = align(p_BM, p_WM, visible)
    refusals = tuple(
        FitRefusal.TOO_FEW if count < config.min_markers
        else FitRefusal.COLLINEAR if width < config.min_spread
        else FitRefusal.RESIDUAL if miss > config.max_residual
        else None
        for count, width, miss in zip(visible.sum(axis=1), found.spread, found.residual, strict=True)
    )  # fmt: skip
    none = np.zeros(len(refusals), dtype=int)
    return Fits(found.p_WB, found.q_WB, found.residual, refusals, none)
