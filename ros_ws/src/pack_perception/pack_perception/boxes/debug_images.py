"""Pictures that show the stages of a detection (Sec. 7.8 of the thesis)."""

from __future__ import annotations

from dataclasses import dataclass, fields
from pathlib import Path

import cv2
import numpy as np

from pack_core.camera import Picture
from pack_core.palletizing.boxes import BoxDetection, DetectionStatus
from pack_core.rotations import Array
from pack_perception.boxes.segmentation import Segmentation

FRAME_WIDTH = 960
"""Width of the drawn pictures [pixel]; they are for eyes, the measuring is done on the whole ones."""
FOUND, REFUSED, AXIS = (40, 220, 60), (235, 60, 50), (60, 120, 255)
"""Colours of what was found, of what was refused, and of the box's x axis, RGB."""


@dataclass(frozen=True)
class DebugImages:
    """One detection's pictures.

    Attributes:
        frame: the whole picture, reduced `(h, w, 3)` RGB.
        roi: the region of interest `(h, w, 3)` RGB.
        mask: 255 where there is box `(h, w)`.
        overlay: the region of interest with the detection drawn into it `(h, w, 3)` RGB.
    """

    frame: Picture
    roi: Picture
    mask: Picture
    overlay: Picture

    def write(self, folder: Path, stem: str) -> list[Path]:
        """Write the pictures as `<stem>_frame.png` and so on, and return their paths."""
        folder.mkdir(parents=True, exist_ok=True)
        paths = []
        for field in fields(self):
            path = folder / f"{stem}_{field.name}.png"
            image = getattr(self, field.name)
            cv2.imwrite(str(path), image if image.ndim == 2 else cv2.cvtColor(image, cv2.COLOR_RGB2BGR))
            paths.append(path)
        return paths


def draw_debug_images(
    picture: Picture, found: Segmentation, outline: Array | None, detection: BoxDetection
) -> DebugImages:
    """Draw the pictures; `outline` `(4, 2)` are the top face's corners in the whole picture, d_x first."""
    height = round(picture.shape[0] * FRAME_WIDTH / picture.shape[1])
    frame = cv2.resize(picture, (FRAME_WIDTH, height), interpolation=cv2.INTER_AREA)
    overlay = np.ascontiguousarray(found.region.copy())
    if outline is None:
        cv2.drawContours(overlay, [contour[:, None] for contour in found.contours], -1, REFUSED, 1)
    else:
        _draw_pose(overlay, outline - found.corner)
    _write_words(overlay, detection)
    return DebugImages(np.asarray(frame, dtype=np.uint8), found.region.copy(), found.mask, overlay)


def _draw_pose(image: Picture, corners: Array) -> None:
    """The rectangle, its middle, and the direction of d_x."""
    points = [tuple(int(value) for value in np.round(corner)) for corner in corners]
    for start, end in zip(points, [*points[1:], points[0]], strict=True):
        cv2.line(image, start, end, FOUND, 1, cv2.LINE_AA)
    middle = corners.mean(axis=0)
    tip = middle + 0.5 * (corners[1] - corners[0])
    start, end = (tuple(int(value) for value in np.round(point)) for point in (middle, tip))
    cv2.arrowedLine(image, start, end, AXIS, 2, cv2.LINE_AA)
    cv2.drawMarker(image, start, AXIS, cv2.MARKER_CROSS, 16, 2)


def _write_words(image: Picture, detection: BoxDetection) -> None:
    is_found = detection.status is DetectionStatus.DETECTED
    text = f"{detection.box_id}: {detection.status.name.lower()} {detection.reason}"
    if detection.X_WB is not None:
        x, y, _ = detection.X_WB.p
        text += f"x {x:.4f} y {y:.4f} m"
    cv2.putText(
        image, text, (8, 20), cv2.FONT_HERSHEY_SIMPLEX, 0.5, FOUND if is_found else REFUSED, 1, cv2.LINE_AA
    )
