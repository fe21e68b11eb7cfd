"""Poses of a few objects, a row each, and differences between them; numpy would take ten times as long.

A pose `(7,)` is a position [m] and a quaternion wxyz. A shift `(6,)` is a translation [m] and a rotation
vector [rad], a twist `(6,)` a velocity [m/s] and an angular velocity [rad/s]; all are in world axes.
"""

from __future__ import annotations

import math

import numba
import numpy as np
import numpy.typing as npt

from pack_core import one_quaternion
from pack_core.rotations import Array

_product = numba.njit(cache=True)(one_quaternion.product)
_rotated = numba.njit(cache=True)(one_quaternion.rotated)
_exp = numba.njit(cache=True)(one_quaternion.exp)
_log = numba.njit(cache=True)(one_quaternion.log)


@numba.njit("f8[:, ::1](f8[:, :], f8[:, :])", cache=True)
def pose_errors(seen: Array, expected: Array) -> Array:
    """Shifts `(k, 6)` from `expected` to `seen` poses, each `(k, 7)`."""
    errors = np.empty((len(seen), 6))
    for i in range(len(seen)):
        for j in range(3):
            errors[i, j] = seen[i, j] - expected[i, j]
        a, b, c, d = seen[i, 3], seen[i, 4], seen[i, 5], seen[i, 6]
        w, x, y, z = _product(a, b, c, d, expected[i, 3], -expected[i, 4], -expected[i, 5], -expected[i, 6])
        length = math.sqrt(w * w + x * x + y * y + z * z)
        if w < 0.0:  # of q and -q, which are the same rotation, the one that turns less
            length = -length
        errors[i, 3], errors[i, 4], errors[i, 5] = _log(w / length, x / length, y / length, z / length)
    return errors


@numba.njit("void(f8[:, :], i8[:, :], f8[:, :])", cache=True)
def shift(qpos: Array, addresses: npt.NDArray[np.int_], shifts: Array) -> None:
    """Shift objects, in place.

    Args:
        qpos: the positions at t times `(t, nq)`, as MuJoCo orders them.
        addresses: where the poses of the k objects are among them `(k, 7)`.
        shifts: of each object, at all times the same `(k, 6)`.
    """
    for i in range(len(shifts)):
        a, b, c, d = _exp(shifts[i, 3], shifts[i, 4], shifts[i, 5])
        for t in range(len(qpos)):
            q = qpos[t]
            for j in range(3):
                q[addresses[i, j]] += shifts[i, j]
            at = addresses[i, 3]  # of the quaternion, whose four components are neighbours
            q[at], q[at + 1], q[at + 2], q[at + 3] = _product(
                a, b, c, d, q[at], q[at + 1], q[at + 2], q[at + 3]
            )


@numba.njit("f8[:, ::1](f8[:, :], f8[:, :])", cache=True)
def shifted(poses: Array, shifts: Array) -> Array:
    """Poses `(k, 7)` after `shifts` `(k, 6)`."""
    rows, addresses = poses.copy(), np.arange(7).reshape(1, 7)
    for i in range(len(rows)):
        shift(rows[i : i + 1], addresses, shifts[i : i + 1])
    return rows


@numba.njit("f8[:, ::1](f8[:, :], f8[:, :], b1)", cache=True)
def turned(poses: Array, twists: Array, is_inverse: bool) -> Array:
    """Twists `(k, 6)` with their angular parts turned from body axes into the world's, or the other way."""
    found = twists.copy()
    sign = -1.0 if is_inverse else 1.0
    for i in range(len(found)):
        w, x, y, z = poses[i, 3], sign * poses[i, 4], sign * poses[i, 5], sign * poses[i, 6]
        found[i, 3], found[i, 4], found[i, 5] = _rotated(w, x, y, z, found[i, 3], found[i, 4], found[i, 5])
    return found
