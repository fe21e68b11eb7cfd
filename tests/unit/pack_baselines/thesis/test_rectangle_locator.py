"""The thesis' pose of a box: the smallest rectangle around the largest contour."""

import cv2
import numpy as np
import pytest

from pack_baselines.thesis.rectangle_locator import left_edge_yaw, locate_by_rectangle
from pack_core.camera import PinholeCamera
from pack_core.palletizing.boxes import DetectionStatus, ExpectedBox
from pack_perception.boxes.box_vision import VisionConfig
from pack_perception.boxes.segmentation import Segmentation, SegmentationConfig, segment
from pack_perception.boxes.trust import DetectionRefusal

CAMERA = PinholeCamera.looking_down([-2.5, 2.5, 3.7], 1400.0, 1920, 1080)
BOX, TOP = ExpectedBox("box", (0.4, 0.3, 0.2), 0.0), 0.9


def corners_of(p: tuple[float, float], yaw_deg: float, size: tuple[float, float] = (0.4, 0.3)) -> np.ndarray:
    """Corners `(4, 2)` [pixel] of a top face in the picture."""
    c, s = np.cos(np.deg2rad(yaw_deg)), np.sin(np.deg2rad(yaw_deg))
    half = 0.5 * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * size
    xy = half @ np.array([[c, s], [-s, c]]) + p
    return CAMERA.project(np.column_stack([xy, np.full(4, TOP)]))


def segmented(*faces: np.ndarray) -> Segmentation:
    """A dark picture with bright faces, segmented."""
    picture = np.full((CAMERA.height, CAMERA.width, 3), 40, dtype=np.uint8)
    for face in faces:
        cv2.fillConvexPoly(picture, np.round(face).astype(np.int32), (200, 200, 200))
    return segment(picture, SegmentationConfig())


@pytest.mark.parametrize("yaw_deg", [-10.0, -3.0, 0.0, 7.5, 10.0])
def test_the_left_edge_has_the_yaw_of_the_box(yaw_deg: float) -> None:
    assert np.rad2deg(left_edge_yaw(corners_of((-2.45, 2.52), yaw_deg))) == pytest.approx(yaw_deg)


def test_the_pose_is_that_of_a_flat_box_to_a_pixel() -> None:
    pixel = (3.7 - TOP) / CAMERA.f
    pose = locate_by_rectangle(segmented(corners_of((-2.45, 2.52), 6.0)), CAMERA, BOX, TOP, VisionConfig())
    assert not isinstance(pose, DetectionRefusal)
    assert pose.centre == pytest.approx([-2.45, 2.52], abs=pixel)
    assert np.rad2deg(pose.yaw) == pytest.approx(6.0, abs=0.5)
    assert pose.size == pytest.approx((0.4, 0.3), abs=2 * pixel)


def test_of_two_things_the_larger_one_counts() -> None:
    both = segmented(corners_of((-2.45, 2.6), 0.0), corners_of((-2.45, 2.2), 0.0, (0.1, 0.1)))
    assert len(both.contours) == 2
    pose = locate_by_rectangle(both, CAMERA, BOX, TOP, VisionConfig())
    assert not isinstance(pose, DetectionRefusal)
    assert pose.centre == pytest.approx([-2.45, 2.6], abs=0.003)


def test_nothing_is_found_where_nothing_stands_out() -> None:
    found = locate_by_rectangle(segmented(), CAMERA, BOX, TOP, VisionConfig())
    assert isinstance(found, DetectionRefusal)
    assert found.status is DetectionStatus.NOT_FOUND
