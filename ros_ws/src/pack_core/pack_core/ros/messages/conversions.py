"""Messages to values and back; no other module knows that messages have xyzw quaternions and stamps.

Every `from_*` raises MessageError for a message that must not be used.
"""

from __future__ import annotations

import struct

import numpy as np
from builtin_interfaces.msg import Duration, Time
from geometry_msgs.msg import Point, Quaternion, Vector3
from geometry_msgs.msg import Pose as PoseMsg

from pack_core import stamps
from pack_core.errors import MessageError
from pack_core.rotations import Array, Pose

WORLD = "world"
ENCAPSULATION = 4
"""Bytes of a serialised message (CDR) before its first field."""
STAMP, STAMP_BIG_ENDIAN = struct.Struct("<iI"), struct.Struct(">iI")
"""A stamp as it is serialised: seconds, nanoseconds."""


def to_stamp(seconds: float) -> Time:
    """A stamp of a time [s]."""
    sec, nanosec = stamps.split(seconds)
    return Time(sec=sec, nanosec=nanosec)


def from_stamp(stamp: Time | Duration) -> float:
    """Seconds of a stamp or duration."""
    return stamps.to_seconds(stamp.sec * stamps.NS_PER_S + stamp.nanosec)


def stamp_in(data: bytes) -> float:
    """Seconds of the stamp in a serialised message that begins with one, or with a header.

    Raises:
        MessageError: the message is too short to have one.
    """
    if len(data) < ENCAPSULATION + STAMP.size:
        raise MessageError(f"message of {len(data)} bytes; one with a stamp has at least 12")
    # The second byte of a CDR message tells the byte order: odd for little endian, as every PC has it.
    sec, nanosec = (STAMP if data[1] & 1 else STAMP_BIG_ENDIAN).unpack_from(data, ENCAPSULATION)
    return stamps.to_seconds(sec * stamps.NS_PER_S + nanosec)


def finite(values: object, what: str) -> Array:
    """The values as an array of floats, refused when one is NaN or infinite."""
    array = np.array(values, dtype=float)
    if not np.isfinite(array).all():
        raise MessageError(f"{what} is not finite: {array.tolist()}")
    return array


def to_point(p: Array) -> Point:
    """A message of a point `(3,)` [m]."""
    return Point(x=float(p[0]), y=float(p[1]), z=float(p[2]))


def to_pose(X: Pose) -> PoseMsg:
    """A message of a pose."""
    w, x, y, z = X.q.tolist()
    return PoseMsg(position=to_point(X.p), orientation=Quaternion(x=x, y=y, z=z, w=w))


def from_pose(message: PoseMsg) -> Pose:
    """The pose in a message, its quaternion normalised."""
    p, o = message.position, message.orientation
    q = finite([o.w, o.x, o.y, o.z], "orientation")
    # Rounding never takes a quaternion this far from length 1; one that nobody filled in may be all zeros.
    if not 0.5 < float(np.linalg.norm(q)) < 2.0:
        raise MessageError(f"orientation is no unit quaternion: {q.tolist()} (wxyz)")
    return Pose(finite([p.x, p.y, p.z], "position"), q)


def to_vector(v: Array) -> Vector3:
    """A message of a vector `(3,)`."""
    return Vector3(x=float(v[0]), y=float(v[1]), z=float(v[2]))


def from_vector(v: Vector3, what: str) -> Array:
    """The vector `(3,)` in a message; `what` names it in errors."""
    return finite([v.x, v.y, v.z], what)
