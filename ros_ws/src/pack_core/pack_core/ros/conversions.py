"""Messages to values and back. The only place that knows xyzw and stamps.

Every `from_*` raises MessageError for a message that must not be used.
"""

from __future__ import annotations

import numpy as np
from builtin_interfaces.msg import Duration, Time
from geometry_msgs.msg import Point, Quaternion, Vector3, WrenchStamped
from geometry_msgs.msg import Pose as PoseMsg

from pack_core import stamps
from pack_core.errors import MessageError
from pack_core.rotations import Array, Pose

WORLD = "world"


def to_stamp(seconds: float) -> Time:
    """Seconds to a stamp."""
    sec, nanosec = stamps.split(seconds)
    return Time(sec=sec, nanosec=nanosec)


def from_stamp(stamp: Time | Duration) -> float:
    """A stamp or duration in seconds."""
    return stamps.to_seconds(stamp.sec * stamps.NS_PER_S + stamp.nanosec)


def finite(values: object, what: str) -> Array:
    """The values as an array of floats, refused when one is NaN or infinite."""
    array = np.array(values, dtype=float)
    if not np.all(np.isfinite(array)):
        raise MessageError(f"{what} is not finite: {array.tolist()}")
    return array


def to_point(p: Array) -> Point:
    """A point `(3,)`."""
    return Point(x=float(p[0]), y=float(p[1]), z=float(p[2]))


def to_pose(X: Pose) -> PoseMsg:
    """A pose."""
    w, x, y, z = X.q.tolist()
    return PoseMsg(position=to_point(X.p), orientation=Quaternion(x=x, y=y, z=z, w=w))


def from_pose(message: PoseMsg) -> Pose:
    """A pose; its quaternion is normalised."""
    p, o = message.position, message.orientation
    q = finite([o.w, o.x, o.y, o.z], "orientation")
    if not 0.5 < float(np.linalg.norm(q)) < 2.0:
        raise MessageError(f"orientation is no unit quaternion: {q.tolist()} (wxyz)")
    return Pose(finite([p.x, p.y, p.z], "position"), q)


def to_vector(v: Array) -> Vector3:
    """A vector `(3,)`."""
    return Vector3(x=float(v[0]), y=float(v[1]), z=float(v[2]))


def from_vector(v: Vector3, what: str) -> Array:
    """A vector `(3,)`; `what` names it in errors."""
    return finite([v.x, v.y, v.z], what)


def to_wrench(time: float, force: Array, torque: Array, frame: str) -> WrenchStamped:
    """Force [N] and torque [N m] in a frame."""
    message = WrenchStamped()
    message.header.stamp, message.header.frame_id = to_stamp(time), frame
    message.wrench.force, message.wrench.torque = to_vector(force), to_vector(torque)
    return message
