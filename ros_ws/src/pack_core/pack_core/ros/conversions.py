"""Messages to values and back. The only place that knows xyzw and stamps.

Every `from_*` raises MessageError for a message that must not be used.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from builtin_interfaces.msg import Duration, Time
from geometry_msgs.msg import Point, Quaternion, Twist, Vector3, WrenchStamped
from geometry_msgs.msg import Pose as PoseMsg
from pack_interfaces.msg import MocapMarkers
from pack_interfaces.msg import ObjectState as ObjectStateMsg
from pack_interfaces.msg import SceneState as SceneStateMsg
from sensor_msgs.msg import JointState
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from pack_core import stamps
from pack_core.errors import MessageError
from pack_core.robots.panda import JOINTS
from pack_core.rotations import Array, Pose
from pack_core.scene.state import JointSample, MarkerFrame, ObjectState, SceneState, Setpoints, Source

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


def to_scene(state: SceneState) -> SceneStateMsg:
    """All objects' states."""
    message = SceneStateMsg()
    message.header.stamp, message.header.frame_id = to_stamp(state.time), WORLD
    message.objects = [
        ObjectStateMsg(
            name=name, pose=to_pose(item.X_WO), source=int(item.source), age=float(item.age),
            twist=Twist(linear=to_vector(item.v_WO_W), angular=to_vector(item.w_WO_W)),
        )
        for name, item in state.objects.items()
    ]  # fmt: skip
    return message


def from_scene(message: SceneStateMsg) -> SceneState:
    """All objects' states."""
    objects = {
        item.name: ObjectState(
            from_pose(item.pose), from_vector(item.twist.linear, f"velocity of {item.name}"),
            from_vector(item.twist.angular, f"angular velocity of {item.name}"),
            _source_of(item), item.age,
        )
        for item in message.objects
    }  # fmt: skip
    return SceneState(from_stamp(message.header.stamp), objects)


def _source_of(item: ObjectStateMsg) -> Source:
    if item.source not in list(Source):
        raise MessageError(f"source of {item.name} is {item.source}; allowed: {[s.value for s in Source]}")
    return Source(item.source)


def to_markers(frame: MarkerFrame) -> MocapMarkers:
    """A motion capture frame."""
    message = MocapMarkers(objects=list(frame.objects))
    message.header.stamp, message.header.frame_id = to_stamp(frame.time), WORLD
    message.object_index = frame.object_index.astype(np.uint8).tolist()
    message.marker_index = frame.marker_index.astype(np.uint8).tolist()
    message.positions = frame.p_WM.ravel().tolist()
    message.cameras = frame.cameras.astype(np.uint8).tolist()
    return message


def from_markers(message: MocapMarkers) -> MarkerFrame:
    """A motion capture frame."""
    n = len(message.object_index)
    if not n == len(message.marker_index) == len(message.cameras) == len(message.positions) / 3:
        raise MessageError(f"marker arrays differ: {n} objects, {len(message.positions)} coordinates")
    index = np.array(message.object_index, dtype=int)
    if n and index.max() >= len(message.objects):
        raise MessageError(f"object_index {index.max()} but only {len(message.objects)} objects")
    return MarkerFrame(
        from_stamp(message.header.stamp), tuple(message.objects), index,
        np.array(message.marker_index, dtype=int),
        finite(message.positions, "marker position").reshape(n, 3), np.array(message.cameras, dtype=int),
    )  # fmt: skip


def to_joint_state(sample: JointSample, names: Sequence[str] = JOINTS) -> JointState:
    """Measured joints of an arm."""
    message = JointState(
        name=list(names), position=sample.q.tolist(), velocity=sample.v.tolist(), effort=sample.tau.tolist()
    )
    message.header.stamp = to_stamp(sample.time)
    return message


def from_joint_state(message: JointState, names: Sequence[str] = JOINTS) -> JointSample:
    """Measured joints of an arm, in its order."""
    if list(message.name) != list(names):
        raise MessageError(f"joint names are {list(message.name)}; expected {list(names)}")
    columns = [finite(values, f"joint {what}") for what, values in _joint_columns(message)]
    return JointSample(from_stamp(message.header.stamp), *columns)


def _joint_columns(message: JointState) -> list[tuple[str, object]]:
    columns = [("position", message.position), ("velocity", message.velocity), ("effort", message.effort)]
    for what, values in columns:
        if len(values) != len(message.name):
            raise MessageError(f"{len(values)} joint {what}s; expected {len(message.name)}")
    return columns


def to_setpoints(setpoints: Setpoints) -> JointTrajectory:
    """Joint references over a horizon."""
    message = JointTrajectory(joint_names=list(JOINTS))
    message.header.stamp = to_stamp(setpoints.time)
    for offset, q, v, tau in zip(setpoints.offsets, setpoints.q, setpoints.v, setpoints.tau, strict=True):
        sec, nanosec = stamps.split(float(offset))
        message.points.append(
            JointTrajectoryPoint(
                positions=q.tolist(), velocities=v.tolist(), effort=tau.tolist(),
                time_from_start=Duration(sec=sec, nanosec=nanosec),
            )
        )  # fmt: skip
    return message


def from_setpoints(message: JointTrajectory) -> Setpoints:
    """Joint references as they came; the driver judges their size and limits."""
    rows = [(from_stamp(p.time_from_start), p.positions, p.velocities, p.effort) for p in message.points]
    try:
        offsets, q, v, tau = (np.array(column, dtype=float) for column in zip(*rows, strict=True))
    except ValueError as error:
        raise MessageError(f"setpoints without points or with rows of different length: {error}") from error
    return Setpoints(from_stamp(message.header.stamp), offsets, q, v, tau)


def to_wrench(time: float, force: Array, torque: Array, frame: str) -> WrenchStamped:
    """Force [N] and torque [N m] in a frame."""
    message = WrenchStamped()
    message.header.stamp, message.header.frame_id = to_stamp(time), frame
    message.wrench.force, message.wrench.torque = to_vector(force), to_vector(torque)
    return message
