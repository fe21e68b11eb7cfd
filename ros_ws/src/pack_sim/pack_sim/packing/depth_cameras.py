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


def cast(model: mujoco.MjModel, data: mujoco.MjData, camera: PinholeCamera, step: int = 1) -> RayImage:
    """The image of a camera as the physics stands, of every `step`-th pixel along both axes."""
    v, u = np.mgrid[0 : camera.height : step, 0 : camera.width : step]
    rays_C = np.stack([(u - camera.c[0]) / camera.f, (v - camera.c[1]) / camera.f, np.ones(u.shape)], axis=-1)
    lengths = np.linalg.norm(rays_C, axis=-1)
    rays_W = rotate(camera.X_WC.q, (rays_C / lengths[..., None]).reshape(-1, 3))
    n = u.size
    distances, geoms, normals = np.empty(n), np.empty(n, dtype=np.int32), np.empty((n, 3))
    mujoco.mj_multiRay(
        model,
        data,
        camera.X_WC.p,
        rays_W.ravel(),
        None,
        True,
        -1,
        geoms,
        distances,
        normals.ravel(),
        n,
        REACH,
    )
    is_hit = distances >= 0.0
    depth = np.where(is_hit, distances, 0.0).reshape(u.shape) / lengths
    cosine = np.where(is_hit, -np.einsum("ij,ij->i", rays_W, normals), 0.0)
    return RayImage(depth, cosine.reshape(u.shape), geoms.reshape(u.shape))


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
        self._static = [self._alike() for _ in self.cameras]
        self._surface_seed = int(rng.integers(2**31))
        self._next = -np.inf
        self._pending: deque[DepthFrame] = deque()

    def update(self, model: mujoco.MjModel, data: mujoco.MjData, time: float) -> None:
        """Expose if a frame is due at `time` [s]; call it at every step of the physics."""
        if time < self._next - ROUNDING:
            return
        period = 1.0 / self._described.rate
        # keep the rate's raster unless more than a period was missed, as at the first frame
        self._next = (self._next if time - self._next < period else time) + period
        self._pending.append(self.capture(model, data, time))

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
            self._measured(cast(model, data, camera), static, losses)
            for camera, static in zip(self.cameras, self._static, strict=True)
        ]
        return DepthFrame(time, np.stack(images))

    def _surface_losses(self, model: mujoco.MjModel) -> Array:
        """Share of pixels that each geom loses `(ngeom + 1,)`, by its name; the last one is for no geom."""
        names = [model.geom(i).name or model.body(model.geom_bodyid[i]).name for i in range(model.ngeom)]
        draws = [
            np.random.default_rng([self._surface_seed, zlib.crc32(name.encode())]).random() for name in names
        ]
        return self._noise.surface_loss * np.array([*draws, 0.0])

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
        return np.where(is_lost | (depth <= 0.0), 0.0, measured)
