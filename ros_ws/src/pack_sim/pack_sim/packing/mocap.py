"""Motion capture: which markers the cameras see, and the positions that they measure."""

from __future__ import annotations

from collections import deque
from typing import Annotated

import mujoco
import numpy as np
import numpy.typing as npt
from pydantic import Field, NonNegativeFloat, PositiveFloat, PositiveInt

from pack_core.config import AT_ONCE, Config
from pack_core.packing.cell import PackingCell
from pack_core.packing.markers import MarkerFrame
from pack_core.packing.scene import Scene
from pack_core.packing.scene_item import TOP_MARKERS
from pack_core.packing.topics import MARKER_RATE
from pack_core.rotations import Array

Counts = npt.NDArray[np.int_]
GRAZE = 0.001
"""A ray that gets this close to a marker's centre has reached the marker: about its radius [m]."""
ROUNDING = 1e-9
"""Tolerance when simulated times are compared [s]."""


class MocapConfig(Config):
    """Parameters of the motion capture system."""

    rate: PositiveFloat = Field(default=MARKER_RATE, description="frames a simulated second [Hz]")
    noise_std: Annotated[NonNegativeFloat, AT_ONCE] = Field(
        default=0.0003, description="standard deviation of every coordinate of a marker [m]"
    )
    latency: Annotated[NonNegativeFloat, AT_ONCE] = Field(
        default=0.010, description="time from exposure to delivery [s]"
    )
    min_cameras: Annotated[PositiveInt, AT_ONCE] = Field(
        default=2, description="cameras that must see a marker"
    )


class MocapSystem:
    """Cameras around the cell that track every object of the scene, the new one included.

    A camera sees a marker that lies in its field of view and that a ray from the camera reaches. Arm, pump,
    container and all objects block rays.

    Args:
        scene: the objects, whose models say where their markers are.
        cell: where the cameras are.
        config: rate, noise and latency.
        rng: source of the noise.

    Attributes:
        config: may be replaced at any time by one of the same rate.
    """

    def __init__(
        self, scene: Scene, cell: PackingCell, config: MocapConfig, rng: np.random.Generator
    ) -> None:
        self.config, self._rng = config, rng
        items = [*scene.objects, scene.new_object]
        used = None if cell.mocap.has_side_markers else TOP_MARKERS
        markers = [item.markers()[:used] for item in items]
        self._names = tuple(item.name for item in items)
        self._object_index = np.repeat(np.arange(len(items)), [len(m) for m in markers])
        self._marker_index = np.concatenate([np.arange(len(m)) for m in markers])
        self._p_BM = np.concatenate(markers)
        self._p_WC = np.array(cell.mocap.cameras)
        axes = np.array(cell.mocap.target) - self._p_WC
        self._axes = axes / np.linalg.norm(axes, axis=1, keepdims=True)
        self._min_cosine = np.cos(np.deg2rad(cell.mocap.half_angle_deg))
        self._next = -np.inf
        self._pending: deque[MarkerFrame] = deque()

    def update(self, model: mujoco.MjModel, data: mujoco.MjData, time: float) -> None:
        """Capture a frame if one is due at `time` [s]; call it at every step of the physics."""
        if time < self._next - ROUNDING:
            return
        late = time - self._next
        period = 1.0 / self.config.rate
        # keep the rate's raster unless more than a period was missed, as at the first frame
        self._next = (self._next if late < period else time) + period
        self._pending.append(self.capture(model, data, time))

    def due(self, time: float) -> list[MarkerFrame]:
        """Frames that are delivered by `time` [s] and were not returned before, oldest first."""
        frames = []
        while self._pending and self._pending[0].time + self.config.latency <= time + ROUNDING:
            frames.append(self._pending.popleft())
        return frames

    def capture(self, model: mujoco.MjModel, data: mujoco.MjData, time: float) -> MarkerFrame:
        """The frame exposed now: markers that enough cameras see, with noise."""
        p_WM = self.marker_positions(data)
        counts = self.visible_counts(model, data, p_WM)
        seen = counts >= self.config.min_cameras
        noise = self._rng.normal(0.0, self.config.noise_std, p_WM.shape)
        return MarkerFrame(
            time,
            self._names,
            self._object_index[seen],
            self._marker_index[seen],
            (p_WM + noise)[seen],
            counts[seen],
        )

    def marker_positions(self, data: mujoco.MjData) -> Array:
        """p_WM `(n, 3)` [m] of all markers, seen or not, without noise."""
        bodies = [data.body(name) for name in self._names]
        R_WB = np.array([body.xmat.reshape(3, 3) for body in bodies])[self._object_index]
        p_WB: Array = np.array([body.xpos for body in bodies])[self._object_index]
        return p_WB + (R_WB @ self._p_BM[:, :, None])[:, :, 0]

    def visible_counts(self, model: mujoco.MjModel, data: mujoco.MjData, p_WM: Array) -> Counts:
        """How many cameras see each of the markers at `p_WM` `(n, 3)`."""
        counts = np.zeros(len(p_WM), dtype=int)
        p_CM = p_WM - self._p_WC[:, None]
        ranges = np.linalg.norm(p_CM, axis=2)
        rays = p_CM / ranges[..., None]
        is_in_view = (p_CM @ self._axes[..., None])[..., 0] >= ranges * self._min_cosine
        for c, p_C in enumerate(self._p_WC):
            in_view = is_in_view[c].nonzero()[0]
            counts[in_view] += _reached(model, data, p_C, rays[c, in_view], ranges[c, in_view])
        return counts


def _reached(
    model: mujoco.MjModel, data: mujoco.MjData, p_C: Array, rays: Array, ranges: Array
) -> npt.NDArray[np.bool_]:
    """Whether unit `rays` `(n, 3)` from `p_C` get as far as `ranges` `(n,)` without hitting anything."""
    n = len(ranges)
    if n == 0:
        return np.zeros(0, dtype=bool)
    geoms, hits = np.empty(n, dtype=np.int32), np.empty(n)
    mujoco.mj_multiRay(
        model, data, p_C, rays.ravel(), None, True, -1, geoms, hits, None, n, float(ranges.max())
    )
    free: npt.NDArray[np.bool_] = (hits < 0.0) | (hits >= ranges - GRAZE)
    return free
