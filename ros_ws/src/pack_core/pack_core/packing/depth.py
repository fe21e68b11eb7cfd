"""Depth cameras over the container: where they hang, how they measure, and what they measured.

Each camera brings one image a period, the distance along its optical axis at every pixel. Where it measured
nothing the image has 0, as ROS has it in 16UC1.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np
import numpy.typing as npt
from pydantic import Field, NonNegativeFloat, PositiveFloat, PositiveInt

from pack_core.camera import PinholeCamera, looking_at
from pack_core.config import Config
from pack_core.packing.topics import DEPTH_CAMERAS
from pack_core.rotations import Array
from pack_core.text.limits import Share

Point = tuple[float, float, float]
Angle = Annotated[float, Field(ge=0, lt=90)]


class DepthNoise(Config):
    """Errors of a stereo camera's depth.

    A stereo camera measures disparity, `focal * baseline / depth`, with an error of a fraction of a pixel; so
    the error of depth grows with its square. Where matching windows overlap, errors are alike; part of them
    stays from image to image.

    Attributes:
        disparity: standard deviation of a disparity [pixel of the matched images].
        matching_focal: focal length of the matched images [pixel].
        baseline: distance between the two lenses [m].
        correlation: standard deviation of the window over which errors are alike [pixel].
        static: share of the variance that stays from image to image.
        lateral: standard deviation of where a pixel truly looks [pixel]; it roughens edges.
        edge: step of depth between neighbours that is an edge [m].
        edge_loss: share of the pixels at edges that bring nothing.
        flying: share of the pixels at edges with a depth between the two surfaces.
        grazing_deg: angle of incidence from which pixels get lost, and that at which all are [deg].
        surface_loss: largest share of pixels that a surface loses as it is dark or shiny; each has its own.
        loss: share of all pixels that bring nothing.
        step: between the depths that an image can tell [m]; 0: none.
        mount_position: standard deviation of where a camera truly hangs, along each axis [m].
        mount_deg: of how it is turned, about each axis [deg].
    """

    disparity: NonNegativeFloat
    matching_focal: PositiveFloat
    baseline: PositiveFloat
    correlation: PositiveFloat
    static: Share
    lateral: NonNegativeFloat
    edge: PositiveFloat
    edge_loss: Share
    flying: Share
    grazing_deg: tuple[Angle, Angle]
    surface_loss: Share
    loss: Share
    step: NonNegativeFloat
    mount_position: NonNegativeFloat
    mount_deg: NonNegativeFloat

    def axial(self, depth: npt.ArrayLike) -> Array:
        """Standard deviation of depths [m]: d depth = depth^2 / (focal baseline) d disparity."""
        return np.asarray(self.disparity * np.square(depth) / (self.matching_focal * self.baseline))


class DepthMount(Config):
    """Where a camera hangs, and the point that it looks at [m]."""

    position: Point
    target: Point


class DepthCameras(Config):
    """The depth cameras, all of the same kind.

    Attributes:
        mounts: where each of them hangs, two or three.
        focal: focal length [pixel].
        width: of an image [pixel].
        height: of an image [pixel].
        rate: images a second [Hz].
        latency: from exposure to delivery [s].
        noise: errors of an image.
    """

    mounts: Annotated[list[DepthMount], Field(min_length=2, max_length=len(DEPTH_CAMERAS))]
    focal: PositiveFloat
    width: PositiveInt
    height: PositiveInt
    rate: PositiveFloat
    latency: NonNegativeFloat
    noise: DepthNoise

    @property
    def names(self) -> tuple[str, ...]:
        """The cameras' names, which their frames have too."""
        return DEPTH_CAMERAS[: len(self.mounts)]

    def cameras(self) -> list[PinholeCamera]:
        """The cameras as described."""
        middle = (0.5 * self.width - 0.5, 0.5 * self.height - 0.5)
        return [
            PinholeCamera(
                looking_at(mount.position, mount.target), self.focal, middle, self.width, self.height
            )
            for mount in self.mounts
        ]


@dataclass(frozen=True)
class DepthFrame:
    """Images of all depth cameras that were exposed at once.

    Attributes:
        time: time of exposure [s].
        images: depth along the optical axis `(cameras, height, width)` [m]; 0 where nothing was measured.
    """

    time: float
    images: Array


SILENCE = 0.3
"""After which the other depth cameras go on alone [s]: four images."""


class FramePairing:
    """Puts images of one exposure together.

    A camera that has been silent for a while is not waited for any longer: its image has 0 everywhere.

    Args:
        cameras: how many there are.
        patience: silence after which a camera is not waited for [s].
    """

    def __init__(self, cameras: int, patience: float = SILENCE) -> None:
        self._cameras, self._patience = cameras, patience
        self._last: list[float] = []
        self._time = -np.inf
        self._images: dict[int, Array] = {}

    @property
    def silent(self) -> tuple[int, ...]:
        """Cameras that are not waited for, by their place in the list."""
        return tuple(i for i, last in enumerate(self._last) if self._time - last > self._patience)

    def add(self, camera: int, time: float, image: Array) -> DepthFrame | None:
        """Take an image `(height, width)` [m] that was exposed at `time` [s].

        Returns:
            The frame that it completes, if it does. Frames that stay incomplete are dropped.
        """
        if not self._last or time < self._last[camera]:  # time has begun anew
            self._last, self._time = [time] * self._cameras, -np.inf
        self._last[camera] = time
        if time < self._time:
            return None
        if time > self._time:
            self._time, self._images = time, {}
        self._images[camera] = image
        silent = self.silent
        if any(i not in self._images and i not in silent for i in range(self._cameras)):
            return None
        nothing = np.zeros_like(image)
        return DepthFrame(time, np.stack([self._images.get(i, nothing) for i in range(self._cameras)]))


def points_of(camera: PinholeCamera, image: Array, every: int = 1) -> Array:
    """Points `(n, 3)` in the world [m] of an image's pixels with a depth, one in `every` each way."""
    v, u = every * np.stack(np.nonzero(image[::every, ::every]))
    z = image[v, u]
    x, y = (u - camera.c[0]) / camera.f, (v - camera.c[1]) / camera.f
    return np.asarray(camera.X_WC.apply(np.column_stack([x * z, y * z, z])))
