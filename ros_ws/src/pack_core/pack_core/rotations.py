"""Rotations and rigid transforms: unit quaternions wxyz, rotation vectors, poses.

Poses compose in monogram notation: `X_WC = X_WB @ X_BC`. A single quaternion is reckoned with in floats
(`one_quaternion`), because every pose comes by here and numpy takes five times as long for it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from pack_core import one_quaternion

Array = npt.NDArray[np.float64]

IDENTITY = np.array([1.0, 0.0, 0.0, 0.0])
"""No turn, as a quaternion wxyz."""
POINTING_DOWN = np.array([0.0, 1.0, 0.0, 0.0])
"""Half a turn about x, as a quaternion wxyz: a tool's or camera's z axis points down, its x axis stays."""

_AXES = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
"""The unit vectors x, y and z."""
_LEFT = np.array(
    [
        [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]],
        [[0, -1, 0, 0], [1, 0, 0, 0], [0, 0, 0, -1], [0, 0, 1, 0]],
        [[0, 0, -1, 0], [0, 0, 0, 1], [1, 0, 0, 0], [0, -1, 0, 0]],
        [[0, 0, 0, -1], [0, 0, -1, 0], [0, 1, 0, 0], [1, 0, 0, 0]],
    ],
    dtype=float,
).reshape(4, 16)
"""The 4 x 4 matrices that multiply a quaternion by 1, i, j and k from the left, a row each: `q @ _LEFT` is
L(q) in q r = L(q) r, for any number of quaternions at once."""
_SKEW = np.array(
    [
        [[0, 0, 0], [0, 0, -1], [0, 1, 0]],
        [[0, 0, 1], [0, 0, 0], [-1, 0, 0]],
        [[0, -1, 0], [1, 0, 0], [0, 0, 0]],
    ],
    dtype=float,
).reshape(3, 9)
"""The 3 x 3 matrices of the cross products with x, y and z, a row each: `u @ _SKEW` is that of u x v."""


def multiply(q_AB: npt.ArrayLike, q_BC: npt.ArrayLike) -> Array:
    """Quaternion product `q_AC`, shapes `(..., 4)`."""
    p, q = np.asarray(q_AB, dtype=float), np.asarray(q_BC, dtype=float)
    if p.ndim == q.ndim == 1:
        return np.array(one_quaternion.product(*p.tolist(), *q.tolist()))
    times_p = (p @ _LEFT).reshape(*p.shape, 4)
    return np.asarray((times_p @ q[..., None])[..., 0])


def conjugate(q: npt.ArrayLike) -> Array:
    """The inverse rotation of unit quaternions, shape `(..., 4)`."""
    return np.asarray(np.asarray(q, dtype=float) * np.array([1.0, -1.0, -1.0, -1.0]))


def rotate(q_AB: npt.ArrayLike, v_B: npt.ArrayLike) -> Array:
    """Vectors `(..., 3)` from frame B into frame A."""
    q = np.asarray(q_AB, dtype=float)
    v = np.asarray(v_B, dtype=float)
    if q.ndim == v.ndim == 1:
        return np.array(one_quaternion.rotated(*q.tolist(), *v.tolist()))
    w, u = q[..., :1, None], q[..., 1:]
    u_cross = (u @ _SKEW).reshape(*u.shape, 3)
    # q v q* = v + 2 w (u x v) + 2 u x (u x v), with t = 2 u x v.
    t = 2.0 * (u_cross @ v[..., None])
    return np.asarray(v + (w * t + u_cross @ t)[..., 0])


def to_matrix(q: npt.ArrayLike) -> Array:
    """Rotation matrices `(..., 3, 3)`."""
    # Column k is the rotated unit vector k; both branches have them as rows first.
    quaternions = np.asarray(q, dtype=float)
    if quaternions.ndim == 1:
        w, a, b, c = quaternions.tolist()
        return np.array([one_quaternion.rotated(w, a, b, c, *axis) for axis in _AXES]).T
    return np.moveaxis(rotate(quaternions[..., None, :], _AXES), -1, -2)


def from_matrix(R: npt.ArrayLike) -> Array:
    """Unit quaternion `(4,)` of a rotation matrix `(3, 3)`, with `w >= 0` (Shepperd's method)."""
    return normalize(one_quaternion.of_matrix(*np.asarray(R, dtype=float).tolist()))


def normalize(q: npt.ArrayLike) -> Array:
    """Unit quaternion with `w >= 0`, shape `(..., 4)`; q and -q are the same rotation."""
    quaternion = np.asarray(q, dtype=float)
    if quaternion.ndim == 1:
        floats = one_quaternion.unit(*quaternion.tolist())
        if floats is not None:
            return np.array(floats)
    unit = quaternion / np.linalg.norm(quaternion, axis=-1, keepdims=True)
    return np.asarray(np.where(unit[..., :1] < 0.0, -unit, unit))


def exp(rotation_vector: npt.ArrayLike) -> Array:
    """Unit quaternions `(..., 4)` of rotation vectors `(..., 3)` [rad]."""
    v = np.asarray(rotation_vector, dtype=float)
    if v.ndim == 1:
        return np.array(one_quaternion.exp(*v.tolist()))
    # (cos h, sin h v / |v|) with h = |v| / 2. numpy's sinc(x) is sin(pi x) / (pi x), and 1 at 0.
    half = 0.5 * np.linalg.norm(v, axis=-1, keepdims=True)
    return np.concatenate([np.cos(half), 0.5 * np.sinc(half / np.pi) * v], axis=-1)


def log(q: npt.ArrayLike) -> Array:
    """Rotation vectors `(..., 3)` [rad], of length at most pi, of unit quaternions `(..., 4)`."""
    quaternion = normalize(q)
    if quaternion.ndim == 1:
        return np.array(one_quaternion.log(*quaternion.tolist()))
    w, u = quaternion[..., :1], quaternion[..., 1:]
    sine = np.linalg.norm(u, axis=-1, keepdims=True)
    angle = 2.0 * np.arctan2(sine, w)  # at most pi, since w >= 0
    # angle / sine goes to 2 as the angle goes to 0.
    scale = np.where(sine > 1e-9, angle / np.where(sine > 1e-9, sine, 1.0), 2.0)
    return scale * u


def angle_between(q_WA: npt.ArrayLike, q_WB: npt.ArrayLike) -> Array:
    """Angle [rad] of the rotation from A to B, shape `(...)`."""
    q_AB = multiply(conjugate(q_WA), q_WB)
    if q_AB.ndim == 1:
        x, y, z = log(q_AB).tolist()
        return np.asarray(math.sqrt(x * x + y * y + z * z))
    return np.asarray(np.linalg.norm(log(q_AB), axis=-1))


def from_yaw(yaw: float) -> Array:
    """Rotation by `yaw` [rad] about z."""
    return np.array([np.cos(yaw / 2), 0.0, 0.0, np.sin(yaw / 2)])


def from_rpy(rpy: npt.ArrayLike) -> Array:
    """Rotation by roll, pitch and yaw `(3,)` [rad] about the fixed x, y and z axes, in this order (URDF)."""
    roll, pitch, yaw = np.asarray(rpy, dtype=float)
    return multiply(from_yaw(yaw), multiply(exp([0.0, pitch, 0.0]), exp([roll, 0.0, 0.0])))


def tilts(towards: Array) -> Array:
    """Rotation vectors `(n, 3)` leaning the z axis to horizontal vectors `(n, 2)` by their lengths [rad]."""
    return np.column_stack([-towards[:, 1], towards[:, 0], np.zeros(len(towards))])


def yaw_of(q: npt.ArrayLike) -> float:
    """Heading [rad] of the rotated x axis in the horizontal plane."""
    x_axis = rotate(q, np.array([1.0, 0.0, 0.0]))
    return float(np.arctan2(x_axis[1], x_axis[0]))


def _frozen(values: npt.ArrayLike) -> Array:
    array = np.array(values, dtype=float)
    array.setflags(write=False)
    return array


@dataclass(frozen=True)
class Pose:
    """Rigid transform X_AB: B's origin `p` `(3,)` [m] and orientation `q` `(4,)` wxyz in A."""

    p: Array
    q: Array = field(default_factory=lambda: IDENTITY)

    def __post_init__(self) -> None:
        object.__setattr__(self, "p", _frozen(self.p))
        object.__setattr__(self, "q", _frozen(normalize(self.q)))

    def __matmul__(self, X_BC: Pose) -> Pose:
        return Pose(self.p + rotate(self.q, X_BC.p), multiply(self.q, X_BC.q))

    def inverse(self) -> Pose:
        """X_BA of X_AB."""
        q_BA = conjugate(self.q)
        return Pose(-rotate(q_BA, self.p), q_BA)

    def apply(self, p_B: npt.ArrayLike) -> Array:
        """Points `(..., 3)` from B into A."""
        return self.p + rotate(self.q, p_B)
