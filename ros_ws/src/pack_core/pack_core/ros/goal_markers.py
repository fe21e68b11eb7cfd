"""The goals of a cell as markers for RViz and Foxglove: where which box is to stand."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import product

import numpy as np
from geometry_msgs.msg import Vector3
from std_msgs.msg import ColorRGBA
from visualization_msgs.msg import Marker, MarkerArray

from pack_core.ros.conversions import WORLD, to_point, to_pose
from pack_core.rotations import Array, Pose

GOALS = "goals"
"""Namespace of the markers."""
VERTICES = "vertices"
"""Namespace of the dots on the vertices."""
VERTEX = ColorRGBA(r=0.85, g=0.2, b=0.15, a=0.9)
VERTEX_SIZE = 0.012
"""Diameter of a dot [m]."""
GOAL = ColorRGBA(r=0.1, g=0.6, b=0.8, a=0.25)
LABEL = ColorRGBA(r=0.1, g=0.1, b=0.1, a=1.0)
LABEL_SIZE = 0.03
"""Height of the letters over a goal [m]."""


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
