"""The arithmetic of a single quaternion on floats, for `rotations`; quaternions are given as w, x, y, z."""

from __future__ import annotations

import math

Quaternion = tuple[float, float, float, float]
Vector = tuple[float, float, float]


def product(a: float, b: float, c: float, d: float, w: float, x: float, y: float, z: float) -> Quaternion:
    """The product of `a + b i + c j + d k` and `w + x i + y j + z k`."""
    return (
        a * w - b * x - c * y - d * z,
        a * x + b * w + c * z - d * y,
        a * y - b * z + c * w + d * x,
        a * z + b * y - c * x + d * w,
    )


def rotated(w: float, a: float, b: float, c: float, x: float, y: float, z: float) -> Vector:
    """The vector v = (x, y, z), rotated by `w + a i + b j + c k`."""
    # v + w t + u x t, with u = (a, b, c) and t = 2 u x v
    t, s, r = 2.0 * (b * z - c * y), 2.0 * (c * x - a * z), 2.0 * (a * y - b * x)
    return x + w * t + b * r - c * s, y + w * s + c * t - a * r, z + w * r + a * s - b * t


def unit(w: float, x: float, y: float, z: float) -> Quaternion | None:
    """The unit quaternion with `w >= 0` of the same rotation; None of a quaternion of length 0."""
    length = math.copysign(math.sqrt(w * w + x * x + y * y + z * z), -1.0 if w < 0.0 else 1.0)
    return (w / length, x / length, y / length, z / length) if length != 0.0 else None


def exp(x: float, y: float, z: float) -> Quaternion:
    """The unit quaternion of a rotation vector [rad]."""
    half = 0.5 * math.sqrt(x * x + y * y + z * z)
    if half == math.inf:  # which sine and cosine refuse
        return math.nan, math.nan, math.nan, math.nan
    scale = 0.5 * math.sin(half) / half if half != 0.0 else 0.5
    return math.cos(half), scale * x, scale * y, scale * z


def log(w: float, x: float, y: float, z: float) -> Vector:
    """The rotation vector [rad], of length at most pi, of a unit quaternion with `w >= 0`."""
    sine = math.sqrt(x * x + y * y + z * z)
    # angle / sine goes to 2 as the angle goes to 0
    scale = 2.0 * math.atan2(sine, w) / sine if sine > 1e-9 else 2.0
    return scale * x, scale * y, scale * z


def of_matrix(a: Vector, b: Vector, c: Vector) -> Quaternion:
    """A multiple of the quaternion of the rotation matrix with rows a, b and c (Shepperd's method)."""
    # Each case is q times four times one of its components. The largest of trace and diagonal tells the
    # largest component, so that nothing small is divided by when q is normalised.
    trace = a[0] + b[1] + c[2]
    if trace >= a[0] and trace >= b[1] and trace >= c[2]:
        return 1.0 + trace, c[1] - b[2], a[2] - c[0], b[0] - a[1]
    if a[0] >= b[1] and a[0] >= c[2]:
        return c[1] - b[2], 1.0 + 2.0 * a[0] - trace, a[1] + b[0], a[2] + c[0]
    if b[1] >= c[2]:
        return a[2] - c[0], b[0] + a[1], 1.0 + 2.0 * b[1] - trace, b[2] + c[1]
    return b[0] - a[1], c[0] + a[2], c[1] + b[2], 1.0 + 2.0 * c[2] - trace
