"""Separates box and table in a picture (Sec. 7.3 to 7.5 of the thesis)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import cv2
import numpy as np
import numpy.typing as npt
from pydantic import Field, NonNegativeFloat, PositiveFloat

from pack_core.camera import Picture
from pack_core.config import Config
from pack_core.rotations import Array

Share = Annotated[float, Field(ge=0, lt=0.5)]


class SegmentationConfig(Config):
    """Parameters of the segmentation."""

    margin_x: Share = Field(0.35, description="of the picture's width that is cut off at either side")
    margin_y: Share = Field(0.27, description="of the picture's height that is cut off above and below")
    blur: PositiveFloat = Field(1.0, description="standard deviation of the Gaussian filter [pixel]")
    strictness: NonNegativeFloat = Field(5.0, description="added to Otsu's threshold, of 255")
    max_foreground: float = Field(0.5, gt=0, lt=1, description="share of the mask above which it is inverted")
    kernel: Annotated[int, Field(ge=1)] = Field(
        7, description="diameter of the opening and closing ellipse [pixel]"
    )
    min_area: float = Field(
        0.002, gt=0, lt=1, description="of the region of interest that a box covers at least"
    )


@dataclass(frozen=True)
class Segmentation:
    """One picture, segmented.

    Attributes:
        corner: column and row of the region of interest in the picture `(2,)`.
        region: the region of interest `(h, w, 3)` RGB.
        value: its smoothed HSV value channel `(h, w)`.
        mask: 255 where there is box `(h, w)`.
        is_dark: whether the box is darker than the rest, so that the mask was inverted.
        contrast: difference between the mean values of the two classes, of 255.
        contours: outlines `(n, 2)`, in the region, of all objects that are large enough, largest first.
    """

    corner: tuple[int, int]
    region: Picture
    value: Picture
    mask: Picture
    is_dark: bool
    contrast: float
    contours: tuple[npt.NDArray[np.int32], ...]


def segment(picture: Picture, config: SegmentationConfig) -> Segmentation:
    """Segment a picture `(H, W, 3)` RGB: crop, smooth, threshold by Otsu, clean, and find contours."""
    height, width = picture.shape[:2]
    left, top = round(config.margin_x * width), round(config.margin_y * height)
    region = picture[top : height - top, left : width - left]
    value = _smooth_value(region, config.blur)
    threshold, _ = cv2.threshold(value, 0, 255, cv2.THRESH_BINARY | cv2.THRESH_OTSU)
    _, mask = cv2.threshold(value, min(threshold + config.strictness, 255.0), 255, cv2.THRESH_BINARY)
    is_dark = cv2.countNonZero(mask) > config.max_foreground * mask.size
    mask = _cleaned(np.asarray(255 - mask if is_dark else mask, dtype=np.uint8), config.kernel)
    contours = _outlines(mask, config.min_area * mask.size)
    return Segmentation((left, top), region, value, mask, is_dark, _contrast(value, threshold), contours)


def _smooth_value(region: Picture, blur: float) -> Picture:
    value = cv2.cvtColor(region, cv2.COLOR_RGB2HSV)[:, :, 2]
    return np.asarray(cv2.GaussianBlur(value, (0, 0), blur), dtype=np.uint8)


def _cleaned(mask: Picture, kernel: int) -> Picture:
    ellipse = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (kernel, kernel))
    opened = cv2.morphologyEx(mask, cv2.MORPH_OPEN, ellipse)
    # Opening has removed specks that are smaller than the kernel; closing fills holes that are.
    return np.asarray(cv2.morphologyEx(opened, cv2.MORPH_CLOSE, ellipse), dtype=np.uint8)


def _outlines(mask: Picture, min_area: float) -> tuple[npt.NDArray[np.int32], ...]:
    contours, _ = cv2.findContours(mask, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    large = [contour for contour in contours if cv2.contourArea(contour) >= min_area]
    large.sort(key=cv2.contourArea, reverse=True)
    return tuple(np.asarray(contour[:, 0, :], dtype=np.int32) for contour in large)


def _contrast(value: Picture, threshold: float) -> float:
    counts: Array = np.bincount(value.ravel(), minlength=256).astype(float)
    levels, is_above = np.arange(256), np.arange(256) > threshold
    if not counts[is_above].sum() or not counts[~is_above].sum():
        return 0.0
    above, below = (np.average(levels[part], weights=counts[part]) for part in (is_above, ~is_above))
    return float(above - below)
