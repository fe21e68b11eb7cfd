"""What RViz and Foxglove draw: the shapes of a MuJoCo model, and where which box is to stand."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import product

import mujoco
import numpy as np
from geometry_msgs.msg import Vector3
from std_msgs.msg import ColorRGBA
from visualization_msgs.msg import Marker, MarkerArray

from pack_core.hull import hull_of
from pack_core.ros.messages.conversions import WORLD, to_point, to_pose
from pack_core.rotations import Array, Pose

HIDDEN_GROUP = 3
"""Geoms of this group and above are for collisions alone, and are not drawn."""
AT_ORIGIN = Pose(np.zeros(3))
"""The pose of a marker whose points are in its frame."""
AS_THEY_ARE = (Marker.TRIANGLE_LIST, np.ones(3), AT_ORIGIN)
"""Kind, scale and place of triangles."""
LATITUDES, LONGITUDES = np.meshgrid(np.deg2rad(np.arange(-90, 91, 30)), np.deg2rad(np.arange(0, 360, 30)))
"""Of the points on a ball, every 30 degrees [rad]."""
LEVEL = np.cos(LATITUDES)
BALL = np.stack([LEVEL * np.cos(LONGITUDES), LEVEL * np.sin(LONGITUDES), np.sin(LATITUDES)], -1).reshape(
    -1, 3
)
"""Points on the unit ball `(84, 3)`, which the ends of a drawn capsule are made of."""
SHEET = 0.004
"""Thickness with which a plane is drawn [m]; its top is the plane."""
GOALS = "goals"
"""Namespace of the markers."""
VERTICES = "vertices"
"""Namespace of the dots on the vertices."""
VERTEX = ColorRGBA(r=0.85, g=0.2, b=0.15, a=0.9)
"""Colour of a dot."""
VERTEX_SIZE = 0.012
"""Diameter of a dot [m]."""
GOAL = ColorRGBA(r=0.1, g=0.6, b=0.8, a=0.25)
LABEL = ColorRGBA(r=0.1, g=0.1, b=0.1, a=1.0)
"""Colours of a goal's box and of the letters over it."""
LABEL_SIZE = 0.03
"""Height of the letters over a goal [m]."""


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
        triangles = _triangles(model, geom)
        found = _kind_and_scale(model, geom) if triangles is None else AS_THEY_ARE
        if found is None or a == 0.0 or model.geom_group[geom] >= HIDDEN_GROUP:
            continue
        kind, scale, X_GM = found
        marker = Marker(ns=namespace, id=geom, type=kind, action=Marker.ADD, frame_locked=True)
        marker.header.frame_id = frame_of(model.body(body).name)
        marker.pose = to_pose(Pose(model.geom_pos[geom], model.geom_quat[geom]) @ X_GM)
        marker.scale = Vector3(x=float(scale[0]), y=float(scale[1]), z=float(scale[2]))
        marker.color = ColorRGBA(r=r, g=g, b=b, a=a)
        if triangles is not None:
            marker.points = [to_point(corner) for corner in triangles.reshape(-1, 3)]
        yield marker


def _triangles(model: mujoco.MjModel, geom: int) -> Array | None:
    """Corners `(n, 3, 3)` [m] in the geom's frame, of what RViz has no shape for; None for the rest."""
    kind = mujoco.mjtGeom(model.geom_type[geom])
    if kind == mujoco.mjtGeom.mjGEOM_MESH:
        mesh = int(model.geom_dataid[geom])
        v, f = int(model.mesh_vertadr[mesh]), int(model.mesh_faceadr[mesh])
        vertices = model.mesh_vert[v : v + model.mesh_vertnum[mesh]]
        return np.asarray(vertices[model.mesh_face[f : f + model.mesh_facenum[mesh]]])
    if kind == mujoco.mjtGeom.mjGEOM_CAPSULE:
        radius, half_core, _ = model.geom_size[geom]
        ends = [radius * BALL + [0.0, 0.0, side * half_core] for side in (-1, 1)]
        return hull_of(np.concatenate(ends)).triangles
    return None


def _kind_and_scale(model: mujoco.MjModel, geom: int) -> tuple[int, Array, Pose] | None:
    """Marker type, edge lengths of its bounding box [m], and X_GM: the marker in the geom's frame."""
    kind, size = mujoco.mjtGeom(model.geom_type[geom]), model.geom_size[geom]
    if kind == mujoco.mjtGeom.mjGEOM_BOX:
        return Marker.CUBE, 2.0 * size, AT_ORIGIN
    if kind == mujoco.mjtGeom.mjGEOM_CYLINDER:
        return Marker.CYLINDER, 2.0 * size[[0, 0, 1]], AT_ORIGIN
    if kind == mujoco.mjtGeom.mjGEOM_SPHERE:
        return Marker.SPHERE, 2.0 * size[[0, 0, 0]], AT_ORIGIN
    if kind == mujoco.mjtGeom.mjGEOM_PLANE and size[0] > 0.0:  # size 0 is a plane without end
        scale = np.array([2.0 * size[0], 2.0 * size[1], SHEET])
        return Marker.CUBE, scale, Pose(np.array([0.0, 0.0, -0.5 * SHEET]))
    return None


def goal_markers(goals: Mapping[str, tuple[Array, Pose]]) -> MarkerArray:
    """A translucent box with its name for every goal, after the removal of the last ones.

    Args:
        goals: edge lengths `(3,)` [m] and X_WG, the pose of the middle, by what goes there.
    """
    markers = [Marker(ns=GOALS, action=Marker.DELETEALL)]
    markers[0].header.frame_id = WORLD
    for number, (name, (size, X_WG)) in enumerate(goals.items()):
        box = _marker(2 * number, Marker.CUBE, X_WG)
        box.scale, box.color = Vector3(x=float(size[0]), y=float(size[1]), z=float(size[2])), GOAL
        label = _marker(2 * number + 1, Marker.TEXT_VIEW_FACING, X_WG)
        label.pose.position = to_point(X_WG.p + np.array([0.0, 0.0, 0.5 * size[2] + LABEL_SIZE]))
        label.text, label.scale.z, label.color = name, LABEL_SIZE, LABEL
        markers += [box, label]
    return MarkerArray(markers=markers)


def vertex_markers(goals: Mapping[str, tuple[Array, Pose]]) -> MarkerArray:
    """A dot on each of the eight vertices of every goal (section 8.5 of the palletizing thesis).

    Args:
        goals: as for `goal_markers`, after whose message this one is to be shown.
    """
    markers = []
    for number, (size, X_WG) in enumerate(goals.values()):
        dots = _marker(number, Marker.SPHERE_LIST, Pose(np.zeros(3)))
        dots.ns, dots.color = VERTICES, VERTEX
        dots.scale = Vector3(x=VERTEX_SIZE, y=VERTEX_SIZE, z=VERTEX_SIZE)
        corners = 0.5 * np.array(size) * np.array(list(product((-1.0, 1.0), repeat=3)))
        dots.points = [to_point(p) for p in X_WG.apply(corners)]
        markers.append(dots)
    return MarkerArray(markers=markers)


def _marker(number: int, kind: int, X_WG: Pose) -> Marker:
    marker = Marker(ns=GOALS, id=number, type=kind, action=Marker.ADD)
    marker.header.frame_id, marker.pose = WORLD, to_pose(X_WG)
    return marker
