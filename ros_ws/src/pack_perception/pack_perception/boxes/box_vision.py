"""Detects the expected box in one picture, or gives the reason why the picture must not be trusted.

The thesis's pipeline (chapter 7) gives a first rectangle. Its edges are then found again with sub-pixel
accuracy on the plane of the top face, and size and edges must pass the checks of `trust.py`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from pydantic import AfterValidator, Field

from pack_core.camera import Picture, PinholeCamera
from pack_core.config import Config
from pack_core.palletizing.boxes import BoxDetection, DetectionStatus, ExpectedBox
from pack_core.register import Register
from pack_core.rotations import Array, Pose, exp, from_yaw, multiply
from pack_perception.boxes.debug_images import DebugImages, draw_debug_images
from pack_perception.boxes.edge_line import EdgeConfig, TopFace, corners_of, find_edges, rough_corners
from pack_perception.boxes.segmentation import Segmentation, SegmentationConfig, segment
from pack_perception.boxes.top_face import TopPose, Viewpoint, top_poses
from pack_perception.boxes.trust import (
    DetectionRefusal,
    TrustConfig,
    all_edges,
    doubt_of_edges,
    doubt_of_size,
    middle_brightness,
    outline_of,
)

PAD_DOWN = exp([0.0, np.pi, 0.0])
"""q_WT of a tool that points straight down with its y axis along the world's: half a turn about y."""


Locator = Callable[
    [Segmentation, PinholeCamera, ExpectedBox, float, "VisionConfig"], TopPose | DetectionRefusal
]
"""Finds the pose of the top face of a box, at a height [m], in a segmented picture, or refuses to."""

LOCATORS: Register[Locator] = Register(
    "locator", "pack_perception.locators", {"edges": "pack_perception.boxes.box_vision:locate_by_edges"}
)
"""The locators by their names, the default first."""


class VisionConfig(Config):
    """Parameters of box vision."""

    locator: Annotated[str, AfterValidator(LOCATORS.known)] = Field(
        "edges", description="what finds the pose of a box in a segmented picture"
    )
    segmentation: SegmentationConfig = SegmentationConfig()
    edge: EdgeConfig = EdgeConfig()
    trust: TrustConfig = TrustConfig()


@dataclass(frozen=True)
class IllustratedDetection:
    """A detection, and the pictures that show its stages."""

    detection: BoxDetection
    images: DebugImages


class BoxVision:
    """Detects boxes that lie on a table of known height."""

    def __init__(self, config: VisionConfig) -> None:
        self._config, self._locate = config, LOCATORS[config.locator]

    def detect(
        self, picture: Picture, camera: PinholeCamera, box: ExpectedBox, table_height: float, time: float
    ) -> IllustratedDetection:
        """Look for the expected box in a picture `(H, W, 3)` RGB taken at `time` [s]."""
        found = segment(picture, self._config.segmentation)
        top = table_height + box.dims[2]
        pose = self._locate(found, camera, box, top, self._config)
        if isinstance(pose, DetectionRefusal):
            detection = BoxDetection(time, box.id, pose.status, pose.reason, None, None, pose.size)
            return IllustratedDetection(detection, draw_debug_images(picture, found, None, detection))
        X_WB = Pose(np.array([*pose.centre, top - 0.5 * box.dims[2]]), from_yaw(pose.yaw))
        X_WT = Pose(np.array([*pose.centre, top]), multiply(from_yaw(pose.yaw), PAD_DOWN))
        detection = BoxDetection(time, box.id, DetectionStatus.DETECTED, "", X_WB, X_WT, pose.size)
        outline = camera.project(X_WB.apply(0.5 * np.array(box.dims) * CORNERS))
        return IllustratedDetection(detection, draw_debug_images(picture, found, outline, detection))


def locate_by_edges(
    found: Segmentation, camera: PinholeCamera, box: ExpectedBox, top: float, config: VisionConfig
) -> TopPose | DetectionRefusal:
    """The pose of the top face at height `top` [m] by its four edges, or a refusal."""
    trust = config.trust
    outline = outline_of(found, trust)
    if isinstance(outline, DetectionRefusal):
        return outline
    face = TopFace(found.value, found.corner, camera, top, found.is_dark)
    rough = all_edges(find_edges(face, rough_corners(outline, face), config.edge))
    if isinstance(rough, DetectionRefusal):
        return rough
    # The same search again, starting from the edges that were found.
    edges = all_edges(find_edges(face, corners_of(rough), config.edge))
    if isinstance(edges, DetectionRefusal):
        return edges
    corners = corners_of(edges)
    camera_height = float(camera.X_WC.p[2]) - top + box.dims[2]
    # A point of the base at a distance x from the foot appears nearer to it by x d_z / camera_height.
    view = Viewpoint(camera.X_WC.p[:2], box.dims[2] / camera_height)
    pose = _likeliest(top_poses(edges, box.dims[:2], view), face.pixel)
    doubt = doubt_of_size(pose, box, face.pixel, trust)
    return doubt or doubt_of_edges(edges, pose, middle_brightness(face, corners), trust) or pose


CORNERS: Array = np.array([[-1.0, -1.0, 1.0], [1.0, -1.0, 1.0], [1.0, 1.0, 1.0], [-1.0, 1.0, 1.0]])
"""Corners of the top face in the box's frame, in units of its half extents; the first edge is along d_x."""


def _likeliest(poses: list[TopPose], pixel: float) -> TopPose:
    """The hypothesis that fits the size better; for a nearly square face, the one with the smaller yaw."""
    first, second = sorted(poses, key=lambda pose: pose.mismatch)
    if second.mismatch - first.mismatch < 2.0 * pixel:
        return min(poses, key=lambda pose: abs(pose.yaw))
    return first
