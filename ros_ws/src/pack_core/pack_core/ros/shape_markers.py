"""Shapes of a MuJoCo model as markers for RViz and Foxglove."""

from __future__ import annotations

from collections.abc import Iterator

import mujoco
import numpy as np
from geometry_msgs.msg import Vector3
from std_msgs.msg import ColorRGBA
from visualization_msgs.msg import Marker

from pack_core.ros.conversions import to_pose
from pack_core.rotations import Array, Pose

HIDDEN_GROUP = 3
"""Geoms of this group and above are for collisions alone, and are not drawn."""
AT_ORIGIN = Pose(np.zeros(3))
SHEET = 0.004
"""Thickness with which a plane is drawn [m]; its top is the plane."""


def frame_of(body: str) -> str:
    """The frame of /tf that goes with a body: its name, without spaces."""
    return body.replace(" ", "_")


def shape_markers(model: mujoco.MjModel, body: int, namespace: str) -> Iterator[Marker]:
    """One marker for each visible shape of a body, in the frame of /tf that has its name.

    The markers move with their frame (`frame_locked`), so that they are sent only when shapes change.
    """
    start, count = int(model.body_geomadr[body]), int(model.body_geomnum[body])
    for geom in range(start, start + count):
        r, g, b, a = (float(value) for value in model.geom_rgba[geom])
        found = _kind_and_scale(model, geom)
        if found is None or a == 0.0 or model.geom_group[geom] >= HIDDEN_GROUP:
            continue
        kind, scale, X_GM = found
        marker = Marker(ns=namespace, id=geom, type=kind, action=Marker.ADD, frame_locked=True)
        marker.header.frame_id = frame_of(model.body(body).name)
        marker.pose = to_pose(Pose(model.geom_pos[geom], model.geom_quat[geom]) @ X_GM)
        marker.scale = Vector3(x=float(scale[0]), y=float(scale[1]), z=float(scale[2]))
        marker.color = ColorRGBA(r=r, g=g, b=b, a=a)
        yield marker


def _kind_and_scale(model: mujoco.MjModel, geom: int) -> tuple[int, Array, Pose] | None:
    """Marker type, edge lengths of its bounding box [m], and X_GM: the marker in the geom's frame."""
    kind, size = mujoco.mjtGeom(model.geom_type[geom]), model.geom_size[geom]
    if kind == mujoco.mjtGeom.mjGEOM_BOX:
        return Marker.CUBE, 2.0 * size, AT_ORIGIN
    if kind == mujoco.mjtGeom.mjGEOM_CYLINDER:
        return Marker.CYLINDER, 2.0 * size[[0, 0, 1]], AT_ORIGIN
    if kind == mujoco.mjtGeom.mjGEOM_SPHERE:
        return Marker.SPHERE, 2.0 * size[[0, 0, 0]], AT_ORIGIN
    if kind == mujoco.mjtGeom.mjGEOM_CAPSULE:  # RViz has no capsules: a cylinder of the whole length
        return Marker.CYLINDER, 2.0 * np.array([size[0], size[0], size[1] + size[0]]), AT_ORIGIN
    if kind == mujoco.mjtGeom.mjGEOM_PLANE and size[0] > 0.0:  # size 0 is a plane without end
        scale = np.array([2.0 * size[0], 2.0 * size[1], SHEET])
        return Marker.CUBE, scale, Pose(np.array([0.0, 0.0, -0.5 * SHEET]))
    return None
