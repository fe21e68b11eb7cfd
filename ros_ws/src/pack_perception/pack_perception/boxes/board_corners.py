"""Finds the calibration board in a picture."""

from __future__ import annotations

import cv2
import numpy as np

from pack_core.camera import Picture
from pack_core.palletizing.calibration_board import CALIBRATION_BOARD, BoardSighting


def sight_board(picture: Picture, time: float) -> BoardSighting:
    """The corners of the board's pattern in a picture `(H, W, 3)` RGB that was taken at `time` [s]."""
    settings = cv2.aruco.DetectorParameters()
    settings.minMarkerPerimeterRate = 0.005  # of the picture's width: markers are 32 of 3840 pixels wide
    detector = cv2.aruco.CharucoDetector(CALIBRATION_BOARD.pattern, cv2.aruco.CharucoParameters(), settings)
    corners, ids, _, _ = detector.detectBoard(cv2.cvtColor(picture, cv2.COLOR_RGB2GRAY))
    width = picture.shape[1]
    if ids is None:
        return BoardSighting(time, width, np.zeros(0, dtype=int), np.zeros((0, 2)))
    pixels = np.asarray(corners, dtype=float).reshape(-1, 2)
    return BoardSighting(time, width, np.asarray(ids, dtype=int).ravel(), pixels)
