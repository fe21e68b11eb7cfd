"""The simulated depth cameras: rays through the physics, with the errors of a stereo camera."""

from __future__ import annotations

import zlib
from collections import deque

import cv2
import mujoco
import numpy as np

from pack_core.camera import PinholeCamera
from pack_core.packing.depth import DepthCameras, DepthFrame, DepthNoise
from pack_core.rotations import Array, Pose, exp, multiply
from pack_sim.packing.camera_rays import CameraRays, RayImage
from pack_sim.packing.depth_errors import PixelErrors, with_errors

ROUNDING = 1e-9
"""Tolerance when simulated times are compared [s]."""


def displaced(camera: PinholeCamera, noise: DepthNoise, rng: np.random.Generator) -> PinholeCamera:
    """The camera as it truly hangs."""
    X_WC = camera.X_WC
    shift = rng.normal(0.0, 1.0, 3) * noise.mount_position
    turn = exp(rng.normal(0.0, 1.0, 3) * np.deg2rad(noise.mount_deg))
    true = Pose(X_WC.p + shift, multiply(turn, X_WC.q))
    return PinholeCamera(true, camera.f, camera.c, camera.width, camera.height)


class DepthCameraSystem:
    """The depth cameras of a cell, which expose together.

    Args:
        described: the cameras as the cell describes them; where they truly hang is drawn.
        rng: source of all errors.
    """

    def __init__(self, described: DepthCameras, rng: np.random.Generator) -> None:
        self._described, self._noise, self._rng = described, described.noise, rng
        self._errors = PixelErrors.of(described.noise)
        self.cameras = [displaced(camera, self._noise, rng) for camera in described.cameras()]
        self._rays = [CameraRays(camera) for camera in self.cameras]
        self._static = [self._alike() for _ in self.cameras]
        self._surface_seed = int(rng.integers(2**31))
        self._surfaces: tuple[mujoco.MjModel, Array] | None = None
        self._next = -np.inf
        self._pending: deque[DepthFrame] = deque()

    def update(self, model: mujoco.MjModel, data: mujoco.MjData, time: float) -> None:
        """Expose if a frame is due at `time` [s]; call it at every step of the physics."""
        if self.is_due(time):
            self.deliver(self.capture(model, data, time))

    def is_due(self, time: float) -> bool:
        """Whether to expose now, at `time` [s]; the next frame is then due a period later."""
        if time < self._next - ROUNDING:
            return False
        period = 1.0 / self._described.rate
        # keep the rate's raster unless more than a period was missed, as at the first frame
        self._next = (self._next if time - self._next < period else time) + period
        return True

    def deliver(self, frame: DepthFrame) -> None:
        """Have a frame returned by `due` once its latency has passed."""
        self._pending.append(frame)

    def due(self, time: float) -> list[DepthFrame]:
        """Frames that are delivered by `time` [s] and were not returned before, oldest first."""
        frames = []
        while self._pending and self._pending[0].time + self._described.latency <= time + ROUNDING:
            frames.append(self._pending.popleft())
        return frames

    def capture(self, model: mujoco.MjModel, data: mujoco.MjData, time: float) -> DepthFrame:
        """The frame exposed now."""
        losses = self._surface_losses(model)
        images = [
            self._measured(rays.cast(model, data), static, losses)
            for rays, static in zip(self._rays, self._static, strict=True)
        ]
        return DepthFrame(time, np.stack(images))

    def _surface_losses(self, model: mujoco.MjModel) -> Array:
        """Share of pixels that each geom loses `(ngeom + 1,)`, by its name; the last one is for no geom."""
        if self._surfaces is not None and self._surfaces[0] is model:
            return self._surfaces[1]
        names = [model.geom(i).name or model.body(model.geom_bodyid[i]).name for i in range(model.ngeom)]
        draws = [
            np.random.default_rng([self._surface_seed, zlib.crc32(name.encode())]).random() for name in names
        ]
        self._surfaces = model, self._noise.surface_loss * np.array([*draws, 0.0])
        return self._surfaces[1]

    def _alike(self) -> Array:
        """Errors `(h, w)` of unit variance that neighbours share."""
        shape, sigma = (self._described.height, self._described.width), self._noise.correlation
        # white noise behind a Gaussian of width sigma has the variance 1 / (4 pi sigma^2)
        smooth = cv2.GaussianBlur(self._rng.normal(size=shape), (0, 0), sigma)
        return np.asarray(smooth * np.sqrt(4.0 * np.pi) * sigma)

    def _measured(self, true: RayImage, static: Array, losses: Array) -> Array:
        """The image with all errors."""
        return with_errors(
            true.depth, true.cosine, true.geoms, static, self._alike(), losses, self._errors, self._rng
        )
