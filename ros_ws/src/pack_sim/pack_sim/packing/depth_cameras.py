"""The simulated depth cameras: rays through the physics, with the errors of a stereo camera."""

from __future__ import annotations

import zlib
from collections import deque
from dataclasses import dataclass

import cv2
import mujoco
import numpy as np
import numpy.typing as npt

from pack_core.camera import PinholeCamera
from pack_core.packing.depth import DepthCameras, DepthFrame, DepthNoise
from pack_core.rotations import Array, Pose, exp, multiply, rotate

REACH = 2.0
"""Nothing farther away is measured [m]."""
ROUNDING = 1e-9
"""Tolerance when simulated times are compared [s]."""

Mask = npt.NDArray[np.bool_]


@dataclass(frozen=True)
class RayImage:
    """What the pixels of a camera meet, without errors.

    Attributes:
        depth: along the optical axis `(height, width)` [m]; 0 where a pixel meets nothing.
        cosine: of the angle of incidence `(height, width)`.
        geoms: ids of the geoms that they meet `(height, width)`; -1 for nothing.
    """

    depth: Array
    cosine: Array
    geoms: npt.NDArray[np.int32]


class CameraRays:
    """The rays of a camera's pixels, which stay the same as long as it hangs where it does.

    Args:
        camera: the camera, as it truly hangs.
    """

    def __init__(self, camera: PinholeCamera) -> None:
        v, u = np.indices((camera.height, camera.width))
        x, y = (u - camera.c[0]) / camera.f, (v - camera.c[1]) / camera.f
        rays_C = np.stack([x, y, np.ones(u.shape)], axis=-1)
        self._origin, self._lengths = camera.X_WC.p, np.linalg.norm(rays_C, axis=-1)
        self._directions = rotate(camera.X_WC.q, (rays_C / self._lengths[..., None]).reshape(-1, 3))

    def cast(self, model: mujoco.MjModel, data: mujoco.MjData) -> RayImage:
        """What the rays meet as the physics stands."""
        shape, n, rays = self._lengths.shape, self._lengths.size, self._directions
        distances, geoms, normals = np.empty(n), np.empty(n, dtype=np.int32), np.empty((n, 3))
        mujoco.mj_multiRay(
            model, data, self._origin, rays.ravel(), None, True, -1, geoms, distances, normals.ravel(), n,
            REACH,
        )  # fmt: skip
        is_hit = distances >= 0.0
        depth = np.where(is_hit, distances, 0.0).reshape(shape) / self._lengths
        cosine = np.where(is_hit, -np.einsum("ij,ij->i", rays, normals), 0.0)
        return RayImage(depth, cosine.reshape(shape), geoms.reshape(shape))


def displaced(camera: PinholeCamera, noise: DepthNoise, rng: np.random.Generator) -> PinholeCamera:
    """The camera as it truly hangs."""
    X_WC = camera.X_WC
    shift = rng.normal(0.0, 1.0, 3) * noise.mount_position
    turn = exp(rng.normal(0.0, 1.0, 3) * np.deg2rad(noise.mount_deg))
    true = Pose(X_WC.p + shift, multiply(turn, X_WC.q))
    return PinholeCamera(true, camera.f, camera.c, camera.width, camera.height)


def edges(depth: Array, step: float) -> tuple[Mask, Array, Array]:
    """Pixels at edges of depth `(h, w)`, and least and largest depth of 3 x 3 neighbours [m]."""
    kernel = np.ones((3, 3), np.uint8)
    known = np.where(depth > 0.0, depth, REACH)
    near, far = cv2.erode(known, kernel), cv2.dilate(known, kernel)
    return np.asarray(far - near > step), np.asarray(near, dtype=float), np.asarray(far, dtype=float)


class DepthCameraSystem:
    """The depth cameras of a cell, which expose together.

    Args:
        described: the cameras as the cell describes them; where they truly hang is drawn.
        rng: source of all errors.
    """

    def __init__(self, described: DepthCameras, rng: np.random.Generator) -> None:
        self._described, self._noise, self._rng = described, described.noise, rng
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
        noise, rng, shape = self._noise, self._rng, true.depth.shape
        rows, columns = np.indices(shape)
        shift = np.rint(rng.normal(0.0, noise.lateral, (2, *shape))).astype(int)
        look = np.clip(rows + shift[0], 0, shape[0] - 1), np.clip(columns + shift[1], 0, shape[1] - 1)
        depth, cosine, geoms = true.depth[look], true.cosine[look], true.geoms[look]
        is_edge, near, far = edges(true.depth, noise.edge)
        chance = rng.random(shape)
        flies = is_edge & (depth > 0.0) & (chance < noise.flying)
        depth = np.where(flies, near + rng.random(shape) * (far - near), depth)
        errors = np.sqrt(noise.static) * static + np.sqrt(1.0 - noise.static) * self._alike()
        measured = depth + noise.axial(depth) * errors
        first, last = np.cos(np.deg2rad(noise.grazing_deg))
        grazing = np.clip((first - cosine) / (first - last), 0.0, 1.0)
        is_lost = is_edge & (chance > 1.0 - noise.edge_loss)
        for share in (grazing, losses[geoms], noise.loss):
            is_lost |= rng.random(shape) < share
        if noise.step > 0.0:
            measured = noise.step * np.rint(measured / noise.step)
        return np.where(is_lost | (depth <= 0.0), 0.0, measured)
