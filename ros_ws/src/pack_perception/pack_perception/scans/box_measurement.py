"""Measures the one box on a table in a scan, of which nothing is known: its pose and its three edges.

Its top is the highest level of what lies on the table. Where that ends follows from the rays beside its
edges, as in the comparison of a scan with what must stand there; here their lengths are unknown, too.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt
from pydantic import Field, PositiveFloat

from pack_core.config import Config
from pack_core.motion.world import Obstacle
from pack_core.rotations import Array, Pose, from_yaw
from pack_perception.scans.face_fit import FINE, depths, inside
from pack_perception.scans.rays import Rays


class BoxMeasurementConfig(Config):
    """When a measurement is believed."""

    least_height: PositiveFloat = Field(
        default=0.03, description="over the table, from which on a ray has met something [m]"
    )
    level: PositiveFloat = Field(default=0.012, description="by which rays to a level top differ at most [m]")
    share: float = Field(
        default=0.97, gt=0, le=1, description="of the rays inside the outline that must meet the top"
    )
    area: PositiveFloat = Field(default=0.0025, description="of the least thing that counts [m^2]")
    slack: PositiveFloat = Field(
        default=0.012, description="beside an edge, in which rays may meet either side [m]"
    )


Flags = npt.NDArray[np.bool_]


@dataclass(frozen=True)
class MeasuredBox:
    """What a scan tells of a box on a table.

    Attributes:
        X_WB: its pose, its origin in its middle, x along its longer level edge, or either if they
            are nearly equal, z up; None: nothing is there.
        size: its edges along x, y and z `(3,)` [m]; zeros where nothing is there.
        sigma: standard deviation of the level edges, about twice that of repeated scans `(2,)` [m].
        doubt: why this may be no box, in words; empty where it is one.
    """

    X_WB: Pose | None
    size: Array
    sigma: Array
    doubt: str


def measure_box(rays: Rays, table: Obstacle, spacing: float, config: BoxMeasurementConfig) -> MeasuredBox:
    """The box on a table.

    Args:
        rays: of a scan of the table.
        table: the table, down to the floor.
        spacing: of the rays at the level of the table [m].
        config: when it is believed.
    """
    ends_T = table.X_WO.inverse().apply(rays.ends_W) - np.array([0.0, 0.0, 0.5 * table.size[2]])
    is_over = np.all(np.abs(ends_T[:, :2]) < 0.5 * table.size[:2], axis=1)
    is_over &= ends_T[:, 2] > config.least_height
    least = config.area / spacing**2
    if is_over.sum() < least:
        return MeasuredBox(None, np.zeros(3), np.zeros(2), "there is nothing on the table")
    upper = np.quantile(ends_T[is_over, 2], 0.95)
    is_top = is_over & (ends_T[:, 2] > upper - 2.0 * config.level)
    top = float(np.median(ends_T[is_top, 2]))
    is_top = is_over & (np.abs(ends_T[:, 2] - top) < config.level)
    if is_top.sum() < least:
        return MeasuredBox(None, np.zeros(3), np.zeros(2), "what is on the table has no level top")
    # Rays from above the middle cross the plane of the top before they go on to what is beside the box.
    start = table.X_WO.inverse().apply(rays.p_W)
    start[2] -= 0.5 * table.size[2]
    way = ends_T - start
    points = start[:2] + ((top - start[2]) / way[:, 2])[:, None] * way[:, :2]
    outline, sigma = _rectangle(points, is_top)
    (x, y, yaw), half = outline[:3], outline[3:]
    doubt = _doubt(points, is_top, is_over, outline, least, config)
    X_TB = Pose(np.array([x, y, 0.5 * (top + table.size[2])]), from_yaw(float(yaw)))
    size = np.array([*(2.0 * half), top])
    return MeasuredBox(table.X_WO @ X_TB, size, 2.0 * sigma, doubt)


STEPS = 12
"""Newton steps to the outline."""
NEAR = 0.04
"""Rays farther from an edge than this tell nothing about it [m]."""
PRIOR = np.array([0.05, 0.05, 0.5, 0.05, 0.05])
"""Standard deviations about the rough rectangle [m, m, rad, m, m]."""


def _rectangle(points: Array, is_on: Flags) -> tuple[Array, Array]:
    """The rectangle that best parts points `(n, 2)` on the top from those beside it.

    Returns:
        x, y, yaw and half its edges `(5,)` [m, m, rad, m, m], and the standard deviation of the half edges
        `(2,)` [m]. The longer one is first, but either may be where they are nearly equal.
    """
    (x, y), (length, width), angle = cv2.minAreaRect(points[is_on].astype(np.float32))
    if length < width:
        length, width, angle = width, length, angle + 90.0
    yaw = (np.deg2rad(angle) + 0.5 * np.pi) % np.pi - 0.5 * np.pi
    rough = np.array([x, y, yaw, 0.5 * length, 0.5 * width])
    outline, sign, information = rough, np.where(is_on, 1.0, -1.0), np.diag(PRIOR**-2)
    near = np.abs(depths(points, rough[3:], rough[:3])) < NEAR
    for _ in range(STEPS):
        depth, slopes = _grown(points[near], outline)
        wrong = 1.0 / (1.0 + np.exp(np.clip(sign[near] * depth / FINE, -50.0, 50.0)))
        gradient = slopes.T @ (sign[near] * wrong) / FINE - (outline - rough) / PRIOR**2
        information = (slopes.T * (wrong * (1.0 - wrong) / FINE**2)) @ slopes + np.diag(PRIOR**-2)
        step = np.linalg.solve(information, gradient)
        outline = outline + step / max(1.0, float(np.max(np.abs(step)) / 0.01))
    return outline, np.sqrt(np.diag(np.linalg.inv(information)))[3:]


def _grown(points: Array, outline: Array) -> tuple[Array, Array]:
    """Depth of points inside the nearest edge `(n,)`, and its slopes along the outline's five numbers."""
    depth, slopes, nearest = inside(points, outline[3:], outline[:3])
    return depth, np.column_stack([slopes, nearest == 0, nearest == 1])


def _doubt(
    points: Array, is_top: Flags, is_over: Flags, outline: Array, least: float, config: BoxMeasurementConfig
) -> str:
    depth = depths(points, outline[3:], outline[:3])
    is_inside = depth > config.slack
    if (share := is_top[is_inside].mean() if is_inside.any() else 0.0) < config.share:
        return f"its top is not one level face: {share:.0%} of it is, {config.share:.0%} are needed"
    if (is_over & (depth < -config.slack)).sum() >= least:
        return "there is more on the table than one box"
    return ""
