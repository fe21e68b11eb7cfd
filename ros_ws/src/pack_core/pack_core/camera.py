"""Pinhole cameras: points in the world to pixels and back."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from pack_core.config import Config
from pack_core.rotations import POINTING_DOWN, Array, Pose, from_matrix

Picture = npt.NDArray[np.uint8]
"""RGB `(height, width, 3)`."""


class LensDistortion(Config):
    """Radial and tangential distortion of a lens, as OpenCV has it (Brown, Conrady)."""

    k1: float = 0.0
    k2: float = 0.0
    p1: float = 0.0
    p2: float = 0.0

    @property
    def coefficients(self) -> Array:
        """`(4,)`, in OpenCV's sequence."""
        return np.array([self.k1, self.k2, self.p1, self.p2])

    @property
    def is_zero(self) -> bool:
        """Whether straight lines stay straight."""
        return not np.any(self.coefficients)


@dataclass(frozen=True)
class PinholeCamera:
    """A camera without distortion.

    Its frame C is that of OpenCV: x to the right in the picture, y down, z forward. A pixel's centre has
    whole coordinates (u to the right, v down), so that a picture spans -0.5 to width - 0.5.

    Attributes:
        X_WC: where it is.
        f: focal length, the same along both axes [pixel].
        c: where the optical axis meets the picture `(2,)` [pixel].
        width: of the picture [pixel].
        height: of the picture [pixel].
    """

    X_WC: Pose
    f: float
    c: tuple[float, float]
    width: int
    height: int

    @classmethod
    def looking_down(cls, p_WC: npt.ArrayLike, f: float, width: int, height: int) -> PinholeCamera:
        """A camera at p_WC `(3,)` that looks straight down, centred; image up is +y of the world."""
        X_WC = Pose(np.asarray(p_WC, dtype=float), POINTING_DOWN)
        return cls(X_WC, f, (0.5 * width - 0.5, 0.5 * height - 0.5), width, height)

    def scaled(self, width: int) -> PinholeCamera:
        """The same camera with pictures of another width, and the height that goes with it [pixel]."""
        # The left edge of both pictures is at -0.5, half a pixel before the first pixel's centre.
        s = width / self.width
        u, v = ((x + 0.5) * s - 0.5 for x in self.c)
        return PinholeCamera(self.X_WC, self.f * s, (u, v), width, round(self.height * s))

    @property
    def K(self) -> Array:
        """The intrinsic matrix `(3, 3)`."""
        return np.array([[self.f, 0.0, self.c[0]], [0.0, self.f, self.c[1]], [0.0, 0.0, 1.0]])

    def project(self, p_W: npt.ArrayLike) -> Array:
        """Pixels `(..., 2)` of points `(..., 3)` [m] in front of the camera."""
        p_C = self.X_WC.inverse().apply(p_W)  # (u, v) = f (x, y) / z + c
        return np.asarray(self.f * p_C[..., :2] / p_C[..., 2:] + self.c)

    def at_height(self, pixels: npt.ArrayLike, z: npt.ArrayLike) -> Array:
        """Points `(..., 3)` at height `z` [m] of the world that are seen at pixels `(..., 2)`."""
        uv = (np.asarray(pixels, dtype=float) - self.c) / self.f
        rays_C = np.concatenate([uv, np.ones((*uv.shape[:-1], 1))], axis=-1)
        rays_W = self.X_WC.apply(rays_C) - self.X_WC.p  # rotated only; from the camera to depth 1
        scale = (np.asarray(z, dtype=float) - self.X_WC.p[2]) / rays_W[..., 2]
        return np.asarray(self.X_WC.p + scale[..., None] * rays_W)


def looking_at(position: npt.ArrayLike, target: npt.ArrayLike) -> Pose:
    """X_WC of a camera at `position` `(3,)` that looks at `target` `(3,)` [m], x level and to the right."""
    p_WC = np.asarray(position, dtype=float)
    forward = (target - p_WC) / np.linalg.norm(target - p_WC)
    right = np.cross(forward, [0.0, 0.0, 1.0])
    if np.linalg.norm(right) < 1e-9:  # it looks straight down, where every horizontal axis is level
        right = np.array([0.0, -1.0, 0.0])
    right = right / np.linalg.norm(right)
    return Pose(p_WC, from_matrix(np.column_stack([right, np.cross(forward, right), forward])))


def seen_pixels(camera: PinholeCamera, lens: LensDistortion, p_W: npt.ArrayLike) -> Array:
    """Pixels `(n, 2)` at which a camera with a lens shows points `(n, 3)` [m]."""
    p_C = camera.X_WC.inverse().apply(p_W)
    pixels, _ = cv2.projectPoints(p_C, np.zeros(3), np.zeros(3), camera.K, lens.coefficients)
    return np.asarray(pixels, dtype=float)[:, 0]


def focal_length(fovy_deg: float, height: int) -> float:
    """Focal length [pixel] of a camera whose picture of `height` rows covers a vertical angle [deg]."""
    # Half the picture's height subtends half the angle: tan(fovy / 2) = (height / 2) / f.
    return float(0.5 * height / np.tan(np.deg2rad(fovy_deg) / 2))
