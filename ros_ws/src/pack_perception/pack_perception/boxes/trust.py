"""The checks that a detection must pass; one that fails is refused with the reason."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from pydantic import Field, PositiveFloat

from pack_core.config import Config
from pack_core.palletizing.boxes import DetectionStatus, ExpectedBox
from pack_core.rotations import Array
from pack_perception.boxes.edge_line import EdgeLine, TopFace
from pack_perception.boxes.segmentation import Segmentation
from pack_perception.boxes.top_face import TopPose


class TrustConfig(Config):
    """The limits that a detection must keep."""

    min_contrast: PositiveFloat = Field(15.0, description="between box and table, of 255")
    min_edge_contrast: PositiveFloat = Field(8.0, description="across an edge, of 255")
    min_inliers: float = Field(0.7, gt=0, le=1, description="share of an edge's points that are on its line")
    min_fill: float = Field(0.85, gt=0, le=1, description="of its rectangle that the outline covers")
    max_skew_deg: PositiveFloat = Field(0.3, description="of an edge against the others")
    max_unevenness: PositiveFloat = Field(
        0.5,
        description="how far the brightness at an edge is from that of the middle, in contrasts of the edge",
    )
    size_tolerance: PositiveFloat = Field(0.001, description="of the measured size; at least a pixel [m]")


@dataclass(frozen=True)
class DetectionRefusal:
    """Why there is no detection.

    Attributes:
        status: the kind of the reason.
        reason: the reason in words.
        size: measured size of the top face, along and across [m]; zeros where nothing was measured.
    """

    status: DetectionStatus
    reason: str
    size: tuple[float, float] = (0.0, 0.0)


def outline_of(found: Segmentation, trust: TrustConfig) -> Array | DetectionRefusal:
    """The outline `(n, 2)` [pixel] of the only object on the table, in the region of interest.

    It is refused where there is no object or more than one, where the object is cut off by the region's
    border, and where it is not a rectangle.
    """
    if found.contrast < trust.min_contrast or not found.contours:
        reason = f"nothing stands out from the table: contrast {found.contrast:.0f} of 255"
        return DetectionRefusal(DetectionStatus.NOT_FOUND, reason)
    outline = found.contours[0]
    height, width = found.mask.shape
    if outline.min() <= 0 or np.any(outline.max(axis=0) >= (width - 1, height - 1)):
        reason = "what stands out reaches the border of the part of the picture that is looked at"
        return DetectionRefusal(DetectionStatus.DOUBTFUL, reason)
    if len(found.contours) > 1:
        reason = f"{len(found.contours)} things stand out from the table; allowed: one box"
        return DetectionRefusal(DetectionStatus.DOUBTFUL, reason)
    sides = cv2.minAreaRect(outline)[1]
    fill = cv2.contourArea(outline) / max(sides[0] * sides[1], 1.0)
    if fill < trust.min_fill:
        reason = f"what stands out fills {fill:.0%} of a rectangle; allowed: at least {trust.min_fill:.0%}"
        return DetectionRefusal(DetectionStatus.DOUBTFUL, reason)
    return np.asarray(outline, dtype=float)


def all_edges(edges: Sequence[EdgeLine | None]) -> list[EdgeLine] | DetectionRefusal:
    """All four edges, or a refusal if one of them was not found."""
    lines = [edge for edge in edges if edge is not None]
    if len(lines) < len(edges):
        reason = f"only {len(lines)} of 4 edges are straight lines"
        return DetectionRefusal(DetectionStatus.DOUBTFUL, reason)
    return lines


def doubt_of_size(
    pose: TopPose, box: ExpectedBox, pixel: float, trust: TrustConfig
) -> DetectionRefusal | None:
    """A refusal unless the top face has the expected size; `pixel` is the width of a pixel on it [m]."""
    tolerance = max(trust.size_tolerance, pixel)
    if pose.mismatch > tolerance:
        along, across = pose.size
        reason = (
            f"the top face measures {along * 1e3:.1f} x {across * 1e3:.1f} mm; box '{box.id}' has "
            f"{box.dims[0] * 1e3:.1f} x {box.dims[1] * 1e3:.1f} mm, allowed: {tolerance * 1e3:.1f} mm off"
        )
        return DetectionRefusal(DetectionStatus.WRONG_SIZE, reason, pose.size)
    return None


def doubt_of_edges(
    edges: Sequence[EdgeLine], pose: TopPose, middle: float, trust: TrustConfig
) -> DetectionRefusal | None:
    """A refusal unless the edges that the pose was computed from are clear, straight, square and the box's.

    Args:
        edges: all four edges.
        pose: the pose computed from them.
        middle: brightness of the middle of the top face.
        trust: the limits.
    """
    for k in pose.sure:
        edge = edges[k]
        angle = np.arctan2(edge.direction[1], edge.direction[0])
        # edges repeat every quarter turn: the difference is brought to -45 to 45 degrees
        skew = np.rad2deg((angle - pose.yaw + 0.25 * np.pi) % (0.5 * np.pi) - 0.25 * np.pi)
        unevenness = abs(edge.inside - middle) / max(edge.contrast, 1.0)
        faults = {
            f"contrast {edge.contrast:.0f} of 255; allowed: at least {trust.min_edge_contrast:g}": (
                edge.contrast < trust.min_edge_contrast
            ),
            f"{edge.inliers:.0%} of its points on a line; allowed: at least {trust.min_inliers:.0%}": (
                edge.inliers < trust.min_inliers
            ),
            f"a skew of {abs(skew):.2f} degrees; allowed: {trust.max_skew_deg:g}": abs(skew)
            > trust.max_skew_deg,
            "beside it what looks like shadow or another thing": unevenness > trust.max_unevenness,
        }
        for fault, is_so in faults.items():
            if is_so:
                return DetectionRefusal(DetectionStatus.DOUBTFUL, f"edge {k + 1} has {fault}", pose.size)
    return None


def middle_brightness(face: TopFace, corners: Array) -> float:
    """Median brightness of the inner part of the top face with corners `(4, 2)` [m]."""
    weights = np.linspace(0.2, 0.8, 15)
    left = corners[0] + weights[:, None] * (corners[3] - corners[0])
    right = corners[1] + weights[:, None] * (corners[2] - corners[1])
    points = left[:, None] + weights[:, None] * (right - left)[:, None]
    return float(np.median(face.brightness(points)))
