"""Compiled kinematics of a serial chain from its joint axes where all joints are zero.

Joint i turns about the line through `points[i]` along `axes[i]`. A point x of link i, given where all
joints are zero, is at `R[i] @ x + d[i]`: the product of exponentials (Brockett, "Robotic manipulators
and the product of exponentials formula", 1984).
"""

from __future__ import annotations

import numba
import numpy as np

from pack_core.rotations import Array

ROUNDING = 1e-9
"""How far a cosine may be beyond 1 and still count as 1."""


@numba.njit(cache=True)
def rotation(axis: Array, angle: float) -> Array:
    """Rotation matrix `(3, 3)` about a unit axis (Rodrigues)."""
    x, y, z = axis
    c, s = np.cos(angle), np.sin(angle)
    k = 1.0 - c
    R = np.empty((3, 3))
    R[0, 0], R[0, 1], R[0, 2] = c + k * x * x, k * x * y - s * z, k * x * z + s * y
    R[1, 0], R[1, 1], R[1, 2] = k * x * y + s * z, c + k * y * y, k * y * z - s * x
    R[2, 0], R[2, 1], R[2, 2] = k * x * z - s * y, k * y * z + s * x, c + k * z * z
    return R


@numba.njit(cache=True)
def cross(a: Array, b: Array) -> Array:
    """Cross product of two vectors `(3,)`."""
    c = np.empty(3)
    c[0] = a[1] * b[2] - a[2] * b[1]
    c[1] = a[2] * b[0] - a[0] * b[2]
    c[2] = a[0] * b[1] - a[1] * b[0]
    return c


@numba.njit(cache=True)
def product(A: Array, B: Array) -> Array:
    """A B of two matrices `(3, 3)`; numba's `@` calls BLAS, which takes ten times longer at this size."""
    C = np.empty((3, 3))
    for i in range(3):
        for j in range(3):
            C[i, j] = A[i, 0] * B[0, j] + A[i, 1] * B[1, j] + A[i, 2] * B[2, j]
    return C


@numba.njit(cache=True)
def transposed_product(A: Array, B: Array) -> Array:
    """A' B of two matrices `(3, 3)`."""
    C = np.empty((3, 3))
    for i in range(3):
        for j in range(3):
            C[i, j] = A[0, i] * B[0, j] + A[1, i] * B[1, j] + A[2, i] * B[2, j]
    return C


@numba.njit(cache=True)
def turned(R: Array, x: Array) -> Array:
    """R x of a matrix `(3, 3)` and a vector `(3,)`."""
    y = np.empty(3)
    for i in range(3):
        y[i] = R[i, 0] * x[0] + R[i, 1] * x[1] + R[i, 2] * x[2]
    return y


@numba.njit(cache=True)
def turned_back(R: Array, x: Array) -> Array:
    """R' x of a matrix `(3, 3)` and a vector `(3,)`."""
    y = np.empty(3)
    for i in range(3):
        y[i] = R[0, i] * x[0] + R[1, i] * x[1] + R[2, i] * x[2]
    return y


@numba.njit(cache=True)
def dot(a: Array, b: Array) -> float:
    """Inner product of two vectors `(3,)`."""
    return float(a[0] * b[0] + a[1] * b[1] + a[2] * b[2])


@numba.njit(cache=True)
def add_cross(a: Array, b: Array, to: Array) -> None:
    """Add the cross product of two vectors `(3,)` to a third one, without memory of its own."""
    to[0] += a[1] * b[2] - a[2] * b[1]
    to[1] += a[2] * b[0] - a[0] * b[2]
    to[2] += a[0] * b[1] - a[1] * b[0]


@numba.njit(cache=True)
def link_transforms(axes: Array, points: Array, q: Array) -> tuple[Array, Array]:
    """How every link has moved from where all joints are zero: `R (n, 3, 3)` and `d (n, 3)`."""
    # exp(xi_1 q_1) ... exp(xi_i q_i): joint i turns about its line, x -> turn (x - point) + point, and the
    # joints before it carry the result along.
    n = len(q)
    R, d = np.empty((n, 3, 3)), np.empty((n, 3))
    for i in range(n):
        turn = rotation(axes[i], q[i])
        moved = turned(turn, points[i])
        for k in range(3):
            d[i, k] = points[i, k] - moved[k]
        if i == 0:
            R[i] = turn
            continue
        R[i] = product(R[i - 1], turn)
        carried = turned(R[i - 1], d[i])
        for k in range(3):
            d[i, k] = carried[k] + d[i - 1, k]
    return R, d


@numba.njit(cache=True)
def world_axes(axes: Array, points: Array, R: Array, d: Array) -> tuple[Array, Array]:
    """Unit axes `(n, 3)` and points `(n, 3)` of the joints where they are now."""
    z, p = np.empty_like(axes), np.empty_like(points)
    for i in range(len(axes)):
        z[i] = turned(R[i], axes[i])
        p[i] = turned(R[i], points[i]) + d[i]
    return z, p


@numba.njit(cache=True)
def jacobian(z: Array, p: Array, point: Array, link: int) -> Array:
    """Jacobian `(6, n)` of a point of a link, world axes: linear rows, then angular rows.

    Joint i turns the point with velocity z_i x (point - p_i); joints beyond the link do not move it.
    """
    J = np.zeros((6, len(z)))
    for i in range(link + 1):
        x, y, h = point[0] - p[i, 0], point[1] - p[i, 1], point[2] - p[i, 2]
        J[0, i] = z[i, 1] * h - z[i, 2] * y
        J[1, i] = z[i, 2] * x - z[i, 0] * h
        J[2, i] = z[i, 0] * y - z[i, 1] * x
        for k in range(3):
            J[3 + k, i] = z[i, k]
    return J


@numba.njit(cache=True)
def link_motion(z: Array, p: Array, v: Array) -> tuple[Array, Array, Array, Array]:
    """Motion of every link at joint velocities `v` and no joint accelerations.

    Returns:
        Angular velocity, angular acceleration, and velocity and acceleration of the joint's point,
        each `(n, 3)`.
    """
    n = len(v)
    w, dw, vp, ap = np.zeros((n, 3)), np.zeros((n, 3)), np.zeros((n, 3)), np.zeros((n, 3))
    # From base to tip: the joint's point moves with the link before it, so that
    # a_i = a_(i-1) + dw x arm + w x (w x arm), and the axis turns with that link, so that dw_i gets w x z v.
    turn, arm, swing = np.empty(3), np.empty(3), np.empty(3)
    for i in range(n):
        for k in range(3):
            turn[k] = z[i, k] * v[i]
            w[i, k] = turn[k]
        if i == 0:
            continue
        for k in range(3):
            arm[k], swing[k] = p[i, k] - p[i - 1, k], 0.0
            vp[i, k], ap[i, k], dw[i, k] = vp[i - 1, k], ap[i - 1, k], dw[i - 1, k]
            w[i, k] += w[i - 1, k]
        add_cross(w[i - 1], arm, swing)
        add_cross(dw[i - 1], arm, ap[i])
        add_cross(w[i - 1], swing, ap[i])
        add_cross(w[i - 1], turn, dw[i])
        for k in range(3):
            vp[i, k] += swing[k]
    return w, dw, vp, ap


@numba.njit(cache=True)
def bias(z: Array, p: Array, v: Array, point: Array, link: int) -> Array:
    """Acceleration `Jdot v` `(6,)` of a point of a link: linear, then angular."""
    w, dw, _, ap = link_motion(z, p, v)
    arm = point - p[link]
    out = np.empty(6)
    out[:3] = ap[link] + cross(dw[link], arm) + cross(w[link], cross(w[link], arm))
    out[3:] = dw[link]
    return out


@numba.njit(cache=True)
def joint_rates(
    axes: Array, points: Array, p_WT: Array, q: Array, rates: Array, accelerations: Array
) -> tuple[Array, Array]:
    """Joint velocities and accelerations `(T, 6)` for those of the tool `(T, 6)`.

    From xdot = J v and xddot = J a + Jdot v. Raises numpy.linalg.LinAlgError where J is singular.
    """
    v, a = np.empty_like(q), np.empty_like(q)
    tip = len(axes) - 1
    for i in range(len(q)):
        R, d = link_transforms(axes, points, q[i])
        z, p = world_axes(axes, points, R, d)
        tool = turned(R[tip], p_WT) + d[tip]
        J = jacobian(z, p, tool, tip)
        v[i] = np.linalg.solve(J, rates[i])
        a[i] = np.linalg.solve(J, accelerations[i] - bias(z, p, v[i], tool, tip))
    return v, a


@numba.njit(cache=True)
def angle_about(k: Array, a: Array, b: Array) -> float:
    """Subproblem 1: the angle about `k` that turns `a` towards `b`; 0 where either is along `k`."""
    # Of the parts of a and b across k, |a'| |b'| times sine and cosine of the angle between them.
    sine = dot(k, cross(a, b))
    cosine = dot(a, b) - dot(k, a) * dot(k, b)
    if sine * sine + cosine * cosine < 1e-24:  # |a'| |b'| < 1e-12: rounding alone would choose the angle
        return 0.0
    return float(np.arctan2(sine, cosine))


@numba.njit(cache=True)
def angles_to_plane(k: Array, h: Array, a: Array, level: float) -> Array:
    """Subproblem 4: both angles `(2,)` about `k` that give the turned `a` the component `level` along `h`.

    The component rises with the angle at the first and falls at the second; NaN where no angle does.
    """
    # Rodrigues: h . R(k, t) a = (h . k)(k . a) + x cos t + y sin t, where the last two terms are
    # radius cos(t - middle).
    along = dot(h, k) * dot(k, a)
    x = dot(h, a) - along
    y = dot(h, cross(k, a))
    radius = np.hypot(x, y)
    if radius < 1e-12:
        return np.full(2, np.nan)
    cosine = (level - along) / radius
    if abs(cosine) > 1.0 + ROUNDING:
        return np.full(2, np.nan)
    half = np.arccos(max(-1.0, min(1.0, float(cosine))))
    middle = np.arctan2(y, x)
    return np.array([middle - half, middle + half])


@numba.njit(cache=True)
def angles_to_distance(k: Array, a: Array, b: Array, distance: float) -> Array:
    """Subproblem 3: both angles `(2,)` about `k` that bring the turned `a` to a distance from `b`."""
    # |R a - b|^2 = a . a + b . b - 2 b . R a, so that subproblem 4 gives the angle.
    level = 0.5 * (dot(a, a) + dot(b, b) - distance * distance)
    return np.asarray(angles_to_plane(k, b, a, float(level)))
