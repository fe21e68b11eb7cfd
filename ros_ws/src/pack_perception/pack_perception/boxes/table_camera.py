"""The overhead camera as box vision takes it: its pictures undistorted, seen from the table's own frame."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np

from pack_core.camera import LensDistortion, Picture, PinholeCamera
from pack_core.palletizing.boxes import BoxDetection, ExpectedBox
from pack_core.palletizing.cell import PalletizingCell
from pack_core.rotations import Array, Pose, to_matrix
from pack_perception.boxes.box_vision import BoxVision, IllustratedDetection


class Rectifier:
    """Turns pictures of a camera with a lens into those of a pinhole camera at the same place.

    Args:
        camera: the camera without its distortion.
        lens: its distortion.
        ideal: the pinhole camera; it may be turned against the other, and have another middle.
    """

    def __init__(self, camera: PinholeCamera, lens: LensDistortion, ideal: PinholeCamera) -> None:
        R_IC = to_matrix(ideal.X_WC.q).T @ to_matrix(camera.X_WC.q)
        size = ideal.width, ideal.height
        self._maps = cv2.initUndistortRectifyMap(
            camera.K, lens.coefficients, R_IC, ideal.K, size, cv2.CV_32FC1
        )

    def __call__(self, picture: Picture) -> Picture:
        """The picture `(H, W, 3)` as the pinhole camera would take it."""
        return np.asarray(cv2.remap(picture, *self._maps, cv2.INTER_LINEAR), dtype=np.uint8)


class TableCamera:
    """Detects boxes on the picking table of a cell, wherever table and camera are and whatever the lens is.

    Box vision knows a level table of known height, in the middle of the picture. So pictures are rectified to
    those of a camera that looks straight down on the middle of the table, seen from a table that stands where
    it nominally does; the poses that are found are moved with the real table.

    Args:
        cell: the cell as it is known, with table, camera and lens.
        vision: detects boxes.
        camera: the camera without its distortion; by default that of the cell.
    """

    def __init__(self, cell: PalletizingCell, vision: BoxVision, camera: PinholeCamera | None = None) -> None:
        self._vision, self._table = vision, cell.picking_table
        seen_by = camera or cell.overhead_camera
        self._camera, self._rectify = seen_by, None
        is_nominal = self._table.displacement.is_zero and cell.camera.displacement.is_zero
        if is_nominal and cell.camera.lens.is_zero:
            return
        X_NW = self._table.displacement.about(
            self._table.middle
        ).inverse()  # N: as the table nominally stands
        actual = replace(seen_by, X_WC=X_NW @ seen_by.X_WC)
        self._camera = _over(actual, self._table.middle)
        self._rectify = Rectifier(actual, cell.camera.lens, self._camera)

    def detect(self, picture: Picture, box: ExpectedBox, time: float) -> IllustratedDetection:
        """Look for the expected box in a picture `(H, W, 3)` RGB taken at `time` [s]."""
        flat = picture if self._rectify is None else self._rectify(picture)
        found = self._vision.detect(flat, self._camera, box, self._table.height, time)
        return replace(found, detection=self._moved(found.detection))

    def _moved(self, detection: BoxDetection) -> BoxDetection:
        return replace(detection, X_WB=self._real(detection.X_WB), X_WT=self._real(detection.X_WT))

    def _real(self, X_NF: Pose | None) -> Pose | None:
        return None if X_NF is None else self._table.displaced(X_NF)


def _over(camera: PinholeCamera, p_W: Array) -> PinholeCamera:
    """A camera at the same place that looks straight down and has a point `(3,)` in its picture's middle."""
    level = PinholeCamera.looking_down(camera.X_WC.p, camera.f, camera.width, camera.height)
    off = level.project(p_W) - level.c
    return replace(level, c=(level.c[0] - float(off[0]), level.c[1] - float(off[1])))
