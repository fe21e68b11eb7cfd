"""The pose of a box as the thesis reads it off a picture (Sec. 7.5 and 7.6): the smallest rectangle.

It believes what it sees: neither contrast nor size are checked, and of several things the largest counts.
"""

from __future__ import annotations

import cv2
import numpy as np

from pack_core.camera import PinholeCamera
from pack_core.palletizing.boxes import DetectionStatus, ExpectedBox
from pack_core.rotations import Array
from pack_perception.boxes.box_vision import VisionConfig
from pack_perception.boxes.segmentation import Segmentation
from pack_perception.boxes.top_face import TopPose
from pack_perception.boxes.trust import DetectionRefusal

QUARTER = 0.5 * np.pi


def locate_by_rectangle(
    found: Segmentation, camera: PinholeCamera, box: ExpectedBox, top: float, _: VisionConfig
) -> TopPose | DetectionRefusal:
    """The pose of the largest contour's smallest rectangle at the working height `top` [m].

    The thesis takes the working height as known; here it is that of the expected box's top.
    """
    if not found.contours:
        return DetectionRefusal(DetectionStatus.NOT_FOUND, "no contour is large enough")
    rectangle = cv2.minAreaRect(found.contours[0])
    corners = cv2.boxPoints(rectangle) + np.array(found.corner)
    middle = camera.at_height(corners.mean(axis=0), top)[:2]
    yaw, pixel = left_edge_yaw(corners), (float(camera.X_WC.p[2]) - top) / camera.f
    sides = sorted((float(side) * pixel for side in rectangle[1]), reverse=True)
    mismatch = max(abs(side - edge) for side, edge in zip(sides, box.dims[:2], strict=True))
    return TopPose(yaw, middle, (sides[0], sides[1]), mismatch, ())


def left_edge_yaw(corners: Array) -> float:
    """Yaw [rad] of a rectangle with corners `(4, 2)` [pixel], by its left edge; from -pi/4 up to pi/4."""
    edges = [(corners[k], corners[(k + 1) % 4]) for k in range(4)]
    first, second = min(edges, key=lambda edge: float(edge[0][0] + edge[1][0]))
    u, v = (first - second) if first[1] < second[1] else (second - first)  # upwards in the picture
    yaw = float(np.arctan2(-u, -v))  # rows of a picture go down, and up is +y of the world
    return (yaw + 0.5 * QUARTER) % QUARTER - 0.5 * QUARTER
