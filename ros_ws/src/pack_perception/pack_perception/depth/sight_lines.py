"""What depth cameras saw through: where a pixel measured something farther away, nothing is in between."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from pack_core.camera import PinholeCamera
from pack_core.rotations import Array

FACING = 0.2
"""Least cosine between a side and the direction to a camera that sees it; behind others points fly."""


@dataclass(frozen=True)
class SightLines:
    """Cameras and what they measured at once.

    Attributes:
        cameras: where they hang.
        images: depth along their optical axes `(cameras, height, width)` [m]; 0 where nothing was measured.
        behind: what a pixel measured is so much farther away than a point that it saw through [m].
    """

    cameras: Sequence[PinholeCamera]
    images: Array
    behind: float

    def is_free(self, points: Array) -> npt.NDArray[np.bool_]:
        """Which of `points` `(n, 3)` [m] a camera saw through `(n,)`."""
        free = np.zeros(len(points), dtype=bool)
        for camera, image in zip(self.cameras, self.images, strict=True):
            p_C = camera.X_WC.inverse().apply(points)
            u, v = np.rint(camera.f * p_C[:, :2] / p_C[:, 2:] + camera.c).astype(int).T
            inside = (u >= 0) & (u < camera.width) & (v >= 0) & (v < camera.height)
            free[inside] |= image[v[inside], u[inside]] > p_C[inside, 2] + self.behind
        return free

    def sees(self, p: Array, normal: Array) -> bool:
        """Whether a camera looks onto a surface with an outward `normal` `(3,)` at `p` `(3,)` [m]."""
        ways = [camera.X_WC.p - p for camera in self.cameras]
        return any(way @ normal > FACING * np.linalg.norm(way) for way in ways)
