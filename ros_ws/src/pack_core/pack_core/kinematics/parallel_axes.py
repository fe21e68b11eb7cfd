"""Closed-form inverse of arms whose axes 2, 3 and 4 are parallel, such as the Universal Robots.

Axes 5 and 6 meet in the wrist's centre. The geometry is read off the chain. After Hawkins, "Analytic inverse
kinematics for the Universal Robots UR-5/UR-10 arms", 2013, written with Paden-Kahan subproblems.
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
"""Up to which components of axes that count as parallel, or at right angles, may be off; rounding stays far
below."""
SINGULAR = 1.0 - 1e-12
"""Cosine of the angle between axis 6 and axes 2 to 4 from which they count as parallel, 1.4e-6 rad apart."""


class ParallelAxes(InverseKinematics):
    """Inverse of an arm with three parallel axes.

    Raises:
        PackError: the chain is not of this kind.
    """

    def __init__(self, chain: SerialChain, lower: Array, upper: Array) -> None:
        z = chain.axes
        are_parallel = chain.n == 6 and max(np.abs(z[2] - z[1]).max(), np.abs(z[3] - z[1]).max()) < TOLERANCE
        if not are_parallel or abs(z[0] @ z[1]) > TOLERANCE:
            raise PackError("such an arm has six joints, axes 2, 3 and 4 of one direction, across axis 1")
        super().__init__(chain, lower, upper, (4, 5), _solve)

    def _slopes(self, z: Array, p: Array, w: Array) -> tuple[float, float]:
        return (p[1] - p[2]) @ np.cross(z[2], p[3] - p[2]), z[1] @ np.cross(z[4], z[5])


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
    # Ri is the rotation of joint i, Ei its whole motion; R = R1 R234 R56, where R234 turns about z[1] alone.
    shoulders = shoulder_angles(z, r, w0, turned(R, w0) + p)
    if np.isnan(shoulders[0]):
        return
    for i in options(only, 4):
        q1 = shoulders[i]
        R1 = rotation(z[0], q1)
        # R6 keeps z[5] and R234 the component along z[1]: z[1] . R5 z[5] = z[1] . R1' R z[5], subproblem 4.
        flips = angles_to_plane(z[4], z[1], z[5], dot(z[1], turned_back(R1, turned(R, z[5]))))
        if np.isnan(flips[0]):
            continue
        for k in options(only, 1):
            q5 = flips[k]
            R5 = rotation(z[4], q5)
            # R' R1 z[1] = R6' R5' z[1], because R234 keeps z[1]: subproblem 1 for the inverse of R6.
            q6 = -angle_about(z[5], turned_back(R5, z[1]), turned_back(R, turned(R1, z[1])))
            R234, v = _rest(z, r, w0, R, p, R1, R5, q6)
            turn = _within_reach(z, r, w0, R5, R234, v)
            if turn != 0.0:
                q6 += turn
                R234, v = _rest(z, r, w0, R, p, R1, R5, q6)
            # E2 keeps the distance from r[1]: |E3 r[3] - r[1]| = |v - r[1]|, subproblem 3.
            elbows = angles_to_distance(z[2], r[3] - r[2], r[1] - r[2], np.sqrt(np.sum((v - r[1]) ** 2)))
            if np.isnan(elbows[0]):
                continue
            # Any vector across z[1] shows by how much R234 turns; this one is z[1] x (1, 1, 1), which
            # would fail only for an arm mounted with z[1] along (1, 1, 1) of the world.
            normal = np.array([z[1][1] - z[1][2], z[1][2] - z[1][0], z[1][0] - z[1][1]])
            lean = angle_about(z[1], normal, turned(R234, normal))
            for j in options(only, 2):
                row = 4 * i + 2 * j + k
                q3 = elbows[j]
                q2 = angle_about(z[1], turned(rotation(z[2], q3), r[3] - r[2]) + r[2] - r[1], v - r[1])
                rows[row] = np.array([q1, q2, q3, lean - q2 - q3, q5, q6])
                found[row] = True


@numba.njit(cache=True)
def _rest(
    z: Array, r: Array, w0: Array, R: Array, p: Array, R1: Array, R5: Array, q6: float
) -> tuple[Array, Array]:
    """What is left for joints 2, 3 and 4: the rotation R234, and v = E2 E3 r[3], since E4 keeps r[3]."""
    R56 = product(R5, rotation(z[5], q6))
    back = turned(R, turned_back(R56, r[3] - w0 + turned(R56, w0)))
    return product(transposed_product(R1, R), R56.T), turned_back(R1, back + p - r[0]) + r[0]


@numba.njit(cache=True)
def _within_reach(z: Array, r: Array, w0: Array, R5: Array, R234: Array, v: Array) -> float:
    """By how much joint 6 turns so that the elbow reaches v, in the wrist's singularity; 0 where it does.

    There axis 6 is along axes 2, 3 and 4, so that any q6 will do, and moves v on a circle about the wrist's
    centre: v = r[1] + c + R(z[1], angle) u. Of all v the nearest to r[1] has u against c, the farthest has
    it along c.
    """
    along = dot(z[5], turned_back(R5, z[1]))
    if abs(along) < SINGULAR:
        return 0.0
    distance = np.sqrt(np.sum((v - r[1]) ** 2))
    upper_arm, forearm = np.sqrt(np.sum((r[2] - r[1]) ** 2)), np.sqrt(np.sum((r[3] - r[2]) ** 2))
    if abs(upper_arm - forearm) <= distance <= upper_arm + forearm:
        return 0.0
    u = turned(R234, r[3] - w0)
    c = v - r[1] - u
    angle = angle_about(z[1], u, -c if distance > upper_arm else c)
    # R234 turns about z[1] by as much more as joint 6 turns less about z[5], which is along it or against it.
    return -angle if along > 0.0 else angle
