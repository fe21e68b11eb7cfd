"""What viewers need of a simulated cell: its frames on /tf, the robot as URDF, and the shapes of objects."""

from __future__ import annotations

from collections.abc import Mapping

import mujoco
import numpy as np
from geometry_msgs.msg import TransformStamped
from std_msgs.msg import String
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import Marker, MarkerArray

from pack_core.robots.urdf import DescribedRobot
from pack_core.ros.contracts import shared
from pack_core.ros.messages.conversions import WORLD, to_stamp
from pack_core.ros.messages.markers import frame_of, shape_markers
from pack_core.ros.node import CellNode
from pack_core.rotations import Array, Pose, conjugate, multiply, rotate

PERIOD = 1.0 / 30.0
"""Time between two messages on /tf while something moves [s of simulated time]."""
REFRESH = 1.0
"""Every frame is sent this often, moved or not: viewers forget frames that they have not heard of [s]."""
MOVED = 1e-5
"""A frame that has moved by less keeps its last transform [m, and per component of the quaternion]."""


class FramePublisher:
    """Publishes /tf, /tf_static, /robot_description and /cell/markers of a simulated cell.

    Only frames that moved are sent, so that a cell at rest costs next to nothing. Links hang from each other
    as in the URDF, everything else that moves from `world`.

    Args:
        node: that publishes.
        robot: the cell's robot; its links are bodies of the simulator's models.
    """

    def __init__(self, node: CellNode, robot: DescribedRobot) -> None:
        self._robot = robot
        self._tf, self._tf_static = node.advertise(shared.TF), node.advertise(shared.TF_STATIC)
        self._markers = node.advertise(shared.CELL_MARKERS)
        self._description = node.advertise(shared.ROBOT_DESCRIPTION)
        self._description.publish(String(data=robot.urdf))
        self._fixed: dict[str, tuple[str, Pose]] = {}
        self._model: mujoco.MjModel | None = None
        self._due = self._full = -np.inf

    def fix(self, frames: Mapping[str, tuple[str, Pose]]) -> None:
        """Set the frames that stand still and are no bodies: X_PF and the parent's name P, by frame F."""
        self._fixed = dict(frames)
        self._model = None  # so that they are sent with the next step

    def step(self, model: mujoco.MjModel, data: mujoco.MjData) -> None:
        """Publish what is due; to be called after every tick.

        Args:
            model: the simulator's present model; another one than before means that objects came or went.
            data: with the bodies' poses of its last step.
        """
        if model is not self._model:
            self._index(model, data)
        elif data.time < self._due:
            return
        self._due = data.time + PERIOD
        p, q = self._relative(data)
        is_refresh = data.time - self._full >= REFRESH
        moved = np.abs(np.hstack([p - self._p, q - self._q])).max(axis=1, initial=0.0) > MOVED
        if is_refresh:
            self._full = data.time
            moved[:] = True
        if moved.any():
            self._p[moved], self._q[moved] = p[moved], q[moved]
            self._send(moved, data.time)

    def _index(self, model: mujoco.MjModel, data: mujoco.MjData) -> None:
        """Look up the bodies of a model, and publish what changes only with it."""
        self._model = model
        links = {model.body(name).id for name in self._robot.links}
        fixed = dict(self._fixed)
        moving: list[tuple[int, int]] = []
        for body in range(1, model.nbody):
            parent = int(model.body_parentid[body]) if body in links else 0
            if _stands_still(model, body, parent):
                name = frame_of(model.body(body).name)
                fixed[name] = (frame_of(model.body(parent).name), _pose_in(data, parent, body))
            else:
                moving.append((parent, body))
        self._parents, self._bodies = (np.array(ids, dtype=int) for ids in zip(*moving, strict=True))
        self._transforms = [_transform(model, parent, body) for parent, body in moving]
        self._p, self._q = self._relative(data)
        self._full = -np.inf
        self._publish_fixed(fixed, float(data.time))
        self._markers.publish(_markers(model, links))

    def _relative(self, data: mujoco.MjData) -> tuple[Array, Array]:
        """X_PB of every moving body B in its parent P: positions `(n, 3)` [m], quaternions wxyz `(n, 4)`."""
        q_PW = conjugate(data.xquat[self._parents])
        p = rotate(q_PW, data.xpos[self._bodies] - data.xpos[self._parents])
        return p, multiply(q_PW, data.xquat[self._bodies])

    def _send(self, moved: Array, time: float) -> None:
        stamp = to_stamp(time)
        message = TFMessage()
        for i in np.flatnonzero(moved):
            transform = self._transforms[i]
            transform.header.stamp = stamp
            _fill(transform, self._p[i], self._q[i])
            message.transforms.append(transform)
        self._tf.publish(message)

    def _publish_fixed(self, fixed: Mapping[str, tuple[str, Pose]], time: float) -> None:
        message = TFMessage()
        for name, (parent, X_PF) in fixed.items():
            transform = TransformStamped(child_frame_id=name)
            transform.header.frame_id, transform.header.stamp = parent, to_stamp(time)
            _fill(transform, X_PF.p, X_PF.q)
            message.transforms.append(transform)
        self._tf_static.publish(message)


def _stands_still(model: mujoco.MjModel, body: int, parent: int) -> bool:
    """Whether a body never moves relative to another; 0 is the world.

    Bodies of one weld id have no joint between them; a mocap body has none either, but is moved from outside.
    """
    return bool(model.body_weldid[body] == model.body_weldid[parent] and model.body_mocapid[body] < 0)


def _pose_in(data: mujoco.MjData, parent: int, body: int) -> Pose:
    X_WP, X_WB = (Pose(data.xpos[i], data.xquat[i]) for i in (parent, body))
    return X_WP.inverse() @ X_WB


def _transform(model: mujoco.MjModel, parent: int, body: int) -> TransformStamped:
    transform = TransformStamped(child_frame_id=frame_of(model.body(body).name))
    transform.header.frame_id = frame_of(model.body(parent).name) if parent else WORLD
    return transform


def _fill(transform: TransformStamped, p: Array, q: Array) -> None:
    translation, rotation = transform.transform.translation, transform.transform.rotation
    translation.x, translation.y, translation.z = p.tolist()
    rotation.w, rotation.x, rotation.y, rotation.z = q.tolist()


def _markers(model: mujoco.MjModel, links: set[int]) -> MarkerArray:
    """Everything but the robot, after the removal of what was shown before."""
    found = [Marker(action=Marker.DELETEALL)]
    found[0].header.frame_id = WORLD
    for body in range(model.nbody):
        if body not in links:
            is_still = _stands_still(model, body, 0)
            found += shape_markers(model, body, "cell" if is_still else "objects")
    return MarkerArray(markers=found)
