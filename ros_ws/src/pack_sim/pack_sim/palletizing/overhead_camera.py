"""The overhead camera of the simulated palletizing cell, and what a real lens and sensor make of light."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from types import TracebackType
from typing import Self

import cv2
import numpy as np
import numpy.typing as npt
from pydantic import Field, NonNegativeFloat

from pack_core.camera import LensDistortion, Picture, PinholeCamera
from pack_core.config import Config
from pack_core.errors import PackError
from pack_core.palletizing.boxes import BoxBody
from pack_core.palletizing.cell import PalletizingCell
from pack_core.palletizing.imperfections import CameraErrors
from pack_core.palletizing.view import CellView
from pack_core.rotations import Array, Pose

Floats = npt.NDArray[np.float32]
MARGIN = 0.03
"""By how much the pinhole camera that is drawn sees more on each side, as a share of the picture's size: a
lens with barrel distortion shows what a pinhole camera of the same focal length has outside its picture."""
STRIP_ROWS = 432
"""Rows that are drawn at a time: the multisampled buffers of software rendering take 60 bytes a pixel, half a
gigabyte for a whole picture of 3840 by 2160. Each strip has shadows computed anew, and MuJoCo's buffers have
480 rows at least."""


class RealLens:
    """Turns pictures of a slightly larger pinhole camera into those of a real one.

    Args:
        camera: the real camera without its distortion.
        lens: its distortion.
        errors: its other errors.
        seed: of where the light comes from, and of the noise.
    """

    def __init__(self, camera: PinholeCamera, lens: LensDistortion, errors: CameraErrors, seed: int) -> None:
        self.drawn = _widened(camera)
        self._errors, self._seed = errors, seed
        self._maps = _distortion_maps(camera, lens, self.drawn)
        self._light = _light(camera, errors, np.random.default_rng([seed, 5]))

    def expose(self, picture: Picture, time: float) -> Picture:
        """The real camera's picture at `time` [s] from the one of `drawn`, both RGB."""
        errors = self._errors
        seen = cv2.remap(picture, *self._maps, cv2.INTER_LINEAR).astype(np.float32)
        if errors.blur:
            seen = np.asarray(cv2.GaussianBlur(seen, (0, 0), errors.blur), dtype=np.float32)
        seen = seen * self._light
        # Shot noise: of n electrons the standard deviation is sqrt(n); read noise adds to it (EMVA 1288).
        electrons = errors.exposure * errors.full_well / 255.0
        deviation = np.sqrt(seen * electrons + errors.read_noise**2) / electrons
        rng = np.random.default_rng([self._seed, 6, round(1e3 * time)])
        seen += deviation * rng.standard_normal(seen.shape, dtype=np.float32)
        return np.asarray(np.clip(np.round(seen), 0, 255), dtype=np.uint8)


def _widened(camera: PinholeCamera) -> PinholeCamera:
    x, y = round(MARGIN * camera.width), round(MARGIN * camera.height)
    c = camera.c[0] + x, camera.c[1] + y
    return replace(camera, c=c, width=camera.width + 2 * x, height=camera.height + 2 * y)


def _distortion_maps(
    camera: PinholeCamera, lens: LensDistortion, drawn: PinholeCamera
) -> tuple[Floats, Floats]:
    """For every pixel of the real picture, where the drawn one shows it, each `(height, width)`."""
    v, u = np.mgrid[: camera.height, : camera.width].astype(np.float32)
    pixels = np.stack([u, v], axis=-1).reshape(-1, 1, 2)
    criteria = (cv2.TERM_CRITERIA_EPS | cv2.TERM_CRITERIA_COUNT, 20, 1e-8)
    ideal = cv2.undistortPoints(pixels, camera.K, lens.coefficients, None, None, drawn.K, criteria)
    maps = ideal.astype(np.float32).reshape(camera.height, camera.width, 2)
    return np.ascontiguousarray(maps[..., 0]), np.ascontiguousarray(maps[..., 1])


def _light(camera: PinholeCamera, errors: CameraErrors, rng: np.random.Generator) -> Floats:
    """Share of the light that reaches each pixel `(height, width, 1)`."""
    v, u = np.mgrid[: camera.height, : camera.width].astype(np.float32)
    x, y = (u - camera.c[0]) / camera.width, (v - camera.c[1]) / camera.height
    corner = (0.5 * camera.width) ** 2 + (0.5 * camera.height) ** 2
    share = 1.0 - errors.vignetting * ((u - camera.c[0]) ** 2 + (v - camera.c[1]) ** 2) / corner
    angle = rng.uniform(0.0, 2.0 * np.pi)
    share *= 1.0 + errors.unevenness * (np.cos(angle) * x + np.sin(angle) * y)
    return np.asarray(share[..., None], dtype=np.float32)


@dataclass(frozen=True)
class Snapshot:
    """The arm's positions `q` `(6,)` [rad] and the boxes' poses X_WB at `time` [s]."""

    time: float
    q: Array
    boxes: Mapping[BoxBody, Pose]


class PalletCameraConfig(Config):
    """Parameters of the overhead camera."""

    width: int = Field(default=3840, ge=320, le=7680, description="of pictures [pixel]; the height follows")
    shadows: bool = Field(default=True, description="whether lights cast shadows")
    rate: NonNegativeFloat = Field(
        default=0.0, description="frames a second, the first at 0 s [Hz]; 0: one whenever it is asked for"
    )

    def exposure_time(self, asked: float) -> float:
        """When the first frame is exposed that is not older than a request at `asked` [s]."""
        # less a hundredth of a frame: a multiple of 1 / rate is no whole number of binary digits
        return float(np.ceil(asked * self.rate - 0.01)) / self.rate if self.rate else asked


class PalletCamera:
    """Draws what the camera sees; a context manager, bound to the thread that enters it.

    Args:
        cell: the cell as it truly is, with the pose of the camera.
        config: size of the pictures.
        seed: of the camera's noise, where the cell's preset has a real camera.
        X_WB: true pose of the arm's base; by default the nominal one.

    Attributes:
        camera: the true camera without distortion; no part of a control loop may use it where the cell's
            preset has a real camera.
    """

    def __init__(
        self, cell: PalletizingCell, config: PalletCameraConfig, seed: int = 0, X_WB: Pose | None = None
    ) -> None:
        self._cell, self._config, self._X_WB = cell, config, X_WB
        self.camera = camera_of(cell, config)
        errors = cell.imperfections.camera
        self._lens = None if errors is None else RealLens(self.camera, cell.camera.lens, errors, seed)
        self._view: CellView | None = None

    def __enter__(self) -> Self:
        """Start drawing; raises PackError when there is no OpenGL to draw with."""
        drawn = self._drawn
        self._view = CellView(
            self._cell, drawn.width, min(STRIP_ROWS, drawn.height), shadows=self._config.shadows,
            X_WB=self._X_WB,
        )  # fmt: skip
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._view is not None:
            self._view.__exit__(kind, error, trace)
            self._view = None

    def picture(self, snapshot: Snapshot) -> Picture:
        """A picture `(height, width, 3)`, RGB; raises PackError outside a `with` statement."""
        if self._view is None:
            raise PackError("the overhead camera draws only inside a `with` statement")
        drawn = self._drawn
        picture = np.empty((drawn.height, drawn.width, 3), dtype=np.uint8)
        for first in range(0, drawn.height, STRIP_ROWS):
            upper = max(0, min(first, drawn.height - STRIP_ROWS))  # the last strip may overlap the one before
            strip = picture[upper : upper + STRIP_ROWS]
            camera = replace(drawn, c=(drawn.c[0], drawn.c[1] - upper), height=len(strip))
            strip[:] = self._view.picture(snapshot.q, snapshot.boxes, camera)
        return picture if self._lens is None else self._lens.expose(picture, snapshot.time)

    @property
    def _drawn(self) -> PinholeCamera:
        """The camera whose picture is drawn."""
        return self.camera if self._lens is None else self._lens.drawn


def camera_of(cell: PalletizingCell, config: PalletCameraConfig) -> PinholeCamera:
    """The cell's overhead camera, scaled to pictures of the configured width."""
    return cell.overhead_camera.scaled(config.width)
