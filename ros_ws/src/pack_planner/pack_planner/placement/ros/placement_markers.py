"""A placement as markers for RViz and Foxglove."""

from __future__ import annotations

import mujoco
import numpy as np
from geometry_msgs.msg import Vector3
from std_msgs.msg import ColorRGBA
from visualization_msgs.msg import Marker, MarkerArray

from pack_core.hull import hull_of, with_fewer_corners
from pack_core.packing.scene import Scene
from pack_core.packing.scene_item import SceneItem
from pack_core.packing.settled_sample import SettledSample
from pack_core.ros.messages.conversions import WORLD, to_point, to_pose, to_stamp
from pack_core.rotations import Array, Pose
from pack_planner.placement.placement_result import PlacementSamples, PlannedPlacement

SETTLED = "placement settled"
"""Namespace of the cheapest sample's objects."""
SETTLED_OPACITY = 0.3
"""So that the objects as they stand are seen through those of a sample."""
INFEASIBLE = ColorRGBA(r=0.4, g=0.4, b=0.4, a=0.35)
CHOSEN = ColorRGBA(r=0.1, g=0.8, b=0.3, a=0.45)
KINDS = {mujoco.mjtGeom.mjGEOM_BOX: Marker.CUBE, mujoco.mjtGeom.mjGEOM_CYLINDER: Marker.CYLINDER}
"""Marker types by geometry type, scaled to the bounding box; other shapes are drawn as triangles."""
MARKER_CORNERS = 60
"""Corners at most of a shape that is drawn as triangles."""
SAMPLE_DIAMETER = 0.004
SAMPLE_HEIGHT = 0.002
"""Diameter of a sample's dot and height of its centre over the base [m]."""
LABEL_SIZE = 0.03
"""Height of the letters that name the cheapest sample's cost [m]."""


def to_visual_markers(
    time: float, placement: PlannedPlacement, scene: Scene, cheapest: SettledSample
) -> MarkerArray:
    """What a viewer shows of a placement, in three namespaces.

    The samples are dots on the base, green (cheap) to red (expensive). The chosen pose and the objects of the
    cheapest sample, where its physics left them, are translucent shapes (Fig. 3).
    """
    markers = [_samples(time, placement.samples), _chosen(time, placement, scene.new_object)]
    return MarkerArray(markers=markers + _settled(time, scene, cheapest))


def _settled(time: float, scene: Scene, sample: SettledSample) -> list[Marker]:
    """The objects of a settled sample, and above the new one what the sample costs."""
    markers = [_shape(time, SETTLED, scene.model_of(name), X_WO) for name, X_WO in sample.poses.items()]
    for i, (marker, name) in enumerate(zip(markers, sample.poses, strict=True)):
        r, g, b = scene.model_of(name).colour
        marker.id, marker.color = i, ColorRGBA(r=r, g=g, b=b, a=SETTLED_OPACITY)
    label = _marker(time, SETTLED, Marker.TEXT_VIEW_FACING)
    X_WN, item = sample.poses[scene.new_object.name], scene.new_object
    label.id, label.text = len(markers), f"cost {sample.cost:.2f}"
    label.pose = to_pose(Pose(X_WN.p + np.array([0.0, 0.0, item.half_extents[2] + LABEL_SIZE]), X_WN.q))
    label.scale.z, label.color = LABEL_SIZE, ColorRGBA(r=0.1, g=0.1, b=0.1, a=1.0)
    return [*markers, label]


def _samples(time: float, samples: PlacementSamples) -> Marker:
    marker = _marker(time, "placement samples", Marker.SPHERE_LIST)
    marker.scale = Vector3(x=SAMPLE_DIAMETER, y=SAMPLE_DIAMETER, z=SAMPLE_DIAMETER)
    marker.points = [to_point(np.array([*row[:2], SAMPLE_HEIGHT])) for row in samples.settled]
    shares = _ranks(samples.costs)
    marker.colors = [
        ColorRGBA(r=share, g=1.0 - share, b=0.1, a=0.9) if is_feasible else INFEASIBLE
        for share, is_feasible in zip(shares.tolist(), samples.is_feasible, strict=True)
    ]
    return marker


def _chosen(time: float, placement: PlannedPlacement, item: SceneItem) -> Marker:
    if placement.X_WO is None:
        marker = _marker(time, "placement", _kind(item))
        marker.action = Marker.DELETE
        return marker
    marker = _shape(time, "placement", item, placement.X_WO)
    marker.color = CHOSEN
    return marker


def _shape(time: float, namespace: str, item: SceneItem, X_WO: Pose) -> Marker:
    """An object's shape at a pose, still without a colour."""
    marker = _marker(time, namespace, _kind(item))
    marker.pose = to_pose(X_WO)
    if marker.type == Marker.TRIANGLE_LIST:
        marker.scale = Vector3(x=1.0, y=1.0, z=1.0)
        hull = with_fewer_corners(hull_of(item.hull()), MARKER_CORNERS, 0.0)
        marker.points = [to_point(corner) for corner in hull.triangles.reshape(-1, 3)]
    else:
        x, y, z = (2 * item.half_extents).tolist()
        marker.scale = Vector3(x=x, y=y, z=z)
    return marker


def _kind(item: SceneItem) -> int:
    return KINDS.get(item.geometry(mujoco.MjSpec())["type"], Marker.TRIANGLE_LIST)


def _marker(time: float, namespace: str, kind: int) -> Marker:
    marker = Marker(ns=namespace, type=kind, action=Marker.ADD)
    marker.header.stamp, marker.header.frame_id = to_stamp(time), WORLD
    marker.pose.orientation.w = 1.0
    return marker


def _ranks(costs: Array) -> Array:
    """Share of cheaper samples `(S,)`; ranks, because costs differ by orders of magnitude."""
    # sorting twice turns costs into their ranks
    return np.argsort(np.argsort(costs)) / max(len(costs) - 1, 1)
