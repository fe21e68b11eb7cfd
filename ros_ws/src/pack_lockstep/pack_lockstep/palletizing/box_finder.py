"""How boxes are found in lockstep: in the camera's pictures, or by the truth with stated noise."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Literal, Protocol

import numpy as np
from pydantic import Field, NonNegativeFloat

from pack_core.config import Config
from pack_core.palletizing.box_detection import BoxDetection, DetectionStatus, ExpectedBox
from pack_core.palletizing.cell import PalletizingCell
from pack_core.rotations import Pose, from_yaw, multiply
from pack_perception.boxes.box_vision import BoxVision, VisionConfig
from pack_sim.palletizing.overhead_camera import PalletCamera, PalletCameraConfig
from pack_sim.palletizing.simulator import PalletSimulator


class NoiseConfig(Config):
    """Noise of a detection, one standard deviation."""

    position: NonNegativeFloat = Field(default=0.0003, description="along each horizontal axis [m]")
    yaw_deg: NonNegativeFloat = Field(default=0.05, description="about the vertical [deg]")


class BoxFinderConfig(Config):
    """How boxes are found."""

    by: Literal["vision", "noise"] = "noise"
    latency: NonNegativeFloat = Field(default=0.2, description="from a picture to its detection [s]")
    noise: NoiseConfig = NoiseConfig()
    camera: PalletCameraConfig = PalletCameraConfig()
    vision: VisionConfig = VisionConfig()


class BoxFinder(Protocol):
    """Finds boxes."""

    def detect(self, expected: ExpectedBox, simulator: PalletSimulator) -> BoxDetection:
        """What is found of the expected box now."""


class NoisyBoxFinder:
    """Sees boxes where they are, and a little beside.

    Args:
        config: the noise.
        rng: its source.
    """

    def __init__(self, config: NoiseConfig, rng: np.random.Generator) -> None:
        self._config, self._rng = config, rng

    def detect(self, expected: ExpectedBox, simulator: PalletSimulator) -> BoxDetection:
        """A detection of the box that truly stands there."""
        X_WB = simulator.truth().objects[expected.id].X_WO
        offset = np.array([*self._rng.normal(0.0, self._config.position, 2), 0.0])
        yaw = np.deg2rad(self._rng.normal(0.0, self._config.yaw_deg))
        seen = Pose(X_WB.p + offset, multiply(from_yaw(yaw), X_WB.q))
        size = (expected.dims[0], expected.dims[1])
        return BoxDetection(simulator.time, expected.id, DetectionStatus.DETECTED, "", seen, None, size)


class CameraBoxFinder:
    """Takes a picture and looks at it.

    Args:
        cell: where the table is.
        camera: draws pictures.
        vision: looks at them.
    """

    def __init__(self, cell: PalletizingCell, camera: PalletCamera, vision: BoxVision) -> None:
        self._cell, self._camera, self._vision = cell, camera, vision

    def detect(self, expected: ExpectedBox, simulator: PalletSimulator) -> BoxDetection:
        """What the vision makes of a picture of now."""
        picture, height = self._camera.picture(simulator.snapshot()), self._cell.picking_table.height
        return self._vision.detect(picture, self._camera.camera, expected, height, simulator.time).detection


@contextmanager
def open_box_finder(
    cell: PalletizingCell, config: BoxFinderConfig, rng: np.random.Generator
) -> Iterator[BoxFinder]:
    """The configured way; `rng` is for its noise.

    Raises:
        PackError: pictures are wanted and there is no OpenGL to draw with.
    """
    if config.by == "noise":
        yield NoisyBoxFinder(config.noise, rng)
        return
    with PalletCamera(cell, config.camera) as camera:
        yield CameraBoxFinder(cell, camera, BoxVision(config.vision))
