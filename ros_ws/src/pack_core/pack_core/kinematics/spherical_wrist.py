"""Closed-form inverse of arms with a spherical wrist, such as most heavy industrial ones.

Axis 1 is perpendicular to the parallel axes 2 and 3; axes 4, 5 and 6 meet in the wrist's centre. The
geometry is read off the chain. After Brandstoetter, Angerer, Hofbaur, "An analytical solution of the
inverse kinematics problem of industrial serial manipulators with an ortho-parallel basis and a
spherical wrist", 2014, written with Paden-Kahan subproblems.
"""

from __future__ import annotations

import numba
import numpy as np

from pack_core.errors import PackError
from pack_core.kinematics.chain import SerialChain
from pack_core.kinematics.inverse import Bools, InverseKinematics, options, shoulder_angles
from pack_core.kinematics.screws import (
    angle_about,
    angles_to_distance,
    angles_to_plane,
    dot,
    product,
    rotation,
    transposed_product,
    turned,
    turned_back,
)
from pack_core.rotations import Array

TOLERANCE = 1e-6
"""Up to which axes that count as parallel, or at right angles, may be off; rounding stays far below."""


class SphericalWrist(InverseKinematics):
    """Inverse of an arm with a spherical wrist.

    Raises:
        PackError: the chain is not of this kind.
    """

    def __init__(self, chain: SerialChain, lower: Array, upper: Array) -> None:
        z = chain.axes
        if chain.n != 6 or abs(z[0] @ z[1]) > TOLERANCE or abs(abs(z[1] @ z[2]) - 1.0) > TOLERANCE:
            raise PackError("such an arm has six joints, axes 2 and 3 parallel, across axis 1")
        super().__init__(chain, lower, upper, (3, 4, 5), _solve)

    def _slopes(self, z: Array, p: Array, w: Array) -> tuple[float, float]:
        return (p[1] - p[2]) @ np.cross(z[2], w - p[2]), z[3] @ np.cross(z[4], z[5])


@numba.njit(cache=True)
def _solve(z: Array, r: Array, w0: Array, R: Array, p: Array, only: int) -> tuple[Array, Bools]:
    """See `Solver`."""
    rows, found = np.zeros((len(p), 8, 6)), np.zeros((len(p), 8), dtype=np.bool_)
    for t in range(len(p)):
        _branches(z, r, w0, R[t], p[t], only, rows[t], found[t])
    return rows, found


@numba.njit(cache=True)
def _branches(
    z: Array, r: Array, w0: Array, R: Array, p: Array, only: int, rows: Array, found: Bools
) -> None:
    # Ri is the rotation of joint i, Ei its whole motion. Joints 4, 5 and 6 keep the wrist's centre, so that
    # joints 1, 2 and 3 alone bring it from w0 to w, and the rotation that is then missing is the wrist's.
    w = turned(R, w0) + p
    shoulders = shoulder_angles(z, r, w0, w)
    if np.isnan(shoulders[0]):
        return
    for i in options(only, 4):
        q1 = shoulders[i]
        R1 = rotation(z[0], q1)
        u = turned_back(R1, w - r[0]) + r[0]
        # E2 E3 w0 = u, and E2 keeps the distance from r[1]: |E3 w0 - r[1]| = |u - r[1]|, subproblem 3.
        elbows = angles_to_distance(z[2], w0 - r[2], r[1] - r[2], np.sqrt(np.sum((u - r[1]) ** 2)))
        if np.isnan(elbows[0]):
            continue
        for j in options(only, 2):
            q3 = elbows[j]
            R3 = rotation(z[2], q3)
            q2 = angle_about(z[1], turned(R3, w0 - r[2]) + r[2] - r[1], u - r[1])
            wrist = transposed_product(product(product(R1, rotation(z[1], q2)), R3), R)
            aim = turned(wrist, z[5])
            # R4 R5 R6 = wrist. R6 keeps z[5], R4 the component along z[3]: z[3] . R5 z[5] = z[3] . aim.
            flips = angles_to_plane(z[4], z[3], z[5], dot(z[3], aim))
            if np.isnan(flips[0]):
                continue
            for k in options(only, 1):
                row = 4 * i + 2 * j + k
                q5 = flips[k]
                R5 = rotation(z[4], q5)
                q4 = angle_about(z[3], turned(R5, z[5]), aim)
                R45 = product(rotation(z[3], q4), R5)
                q6 = angle_about(z[5], z[4], turned_back(R45, turned(wrist, z[4])))
                rows[row] = np.array([q1, q2, q3, q4, q5, q6])
                found[row] = True
