"""The overhead camera as box vision takes it: its pictures undistorted, seen from the table's own frame."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np

from pack_core.camera import LensDistortion, PinholeCamera
from pack_core.palletizing.box_detection import BoxDetection, ExpectedBox
from pack_core.palletizing.cell import PalletizingCell
from pack_core.rotations import Pose
from pack_perception.boxes.box_vision import BoxVision, IllustratedDetection
from pack_perception.boxes.segmentation import Picture


class Undistorter:
    """Removes a lens's distortion from pictures.

    Args:
        camera: the camera without its distortion; undistorted pictures are those that it would take.
        lens: its distortion.
    """

    def __init__(self, camera: PinholeCamera, lens: LensDistortion) -> None:
        self._maps = None
        if not lens.is_zero:
            size = camera.width, camera.height
            self._maps = cv2.initUndistortRectifyMap(
                camera.K, lens.coefficients, None, camera.K, size, cv2.CV_32FC1
            )

    def __call__(self, picture: Picture) -> Picture:
        """The picture `(H, W, 3)` as a camera without distortion would take it."""
        if self._maps is None:
            return picture
        return np.asarray(cv2.remap(picture, *self._maps, cv2.INTER_LINEAR), dtype=np.uint8)


class TableCamera:
    """Detects boxes on the picking table of a cell, wherever table and camera are and whatever the lens is.

    Box vision knows a level table of known height. So the camera's pose is given to it as seen from a table
    that stands where it nominally does, and the poses that it finds are moved with the real one.

    Args:
        cell: the cell as it is known, with table, camera and lens.
        vision: detects boxes.
        camera: the camera without its distortion; by default that of the cell.
    """

    def __init__(self, cell: PalletizingCell, vision: BoxVision, camera: PinholeCamera | None = None) -> None:
        self._vision, self._table = vision, cell.picking_table
        seen_by = camera or cell.overhead_camera
        self._undistort = Undistorter(seen_by, cell.camera.lens)
        self._camera = seen_by
        if not self._table.displacement.is_zero:
            X_NW = self._table.displacement.about(self._table.middle).inverse()  # N: as it nominally stands
            self._camera = replace(seen_by, X_WC=X_NW @ seen_by.X_WC)

    def detect(self, picture: Picture, box: ExpectedBox, time: float) -> IllustratedDetection:
        """Look for the expected box in a picture `(H, W, 3)` RGB taken at `time` [s]."""
        flat = self._undistort(picture)
        found = self._vision.detect(flat, self._camera, box, self._table.height, time)
        return replace(found, detection=self._moved(found.detection))

    def _moved(self, detection: BoxDetection) -> BoxDetection:
        return replace(detection, X_WB=self._real(detection.X_WB), X_WT=self._real(detection.X_WT))

    def _real(self, X_NF: Pose | None) -> Pose | None:
        return None if X_NF is None else self._table.displaced(X_NF)
