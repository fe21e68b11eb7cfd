"""How boxes are detected in lockstep: in the camera's pictures, or by their true pose with added noise."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Literal, Protocol

import numpy as np
from pydantic import Field, NonNegativeFloat

from pack_core.config import Config
from pack_core.palletizing.boxes import BoxDetection, DetectionStatus, ExpectedBox
from pack_core.palletizing.cell import PalletizingCell
from pack_core.rotations import Pose, from_yaw, multiply
from pack_perception.boxes.box_vision import BoxVision, VisionConfig
from pack_perception.boxes.table_camera import TableCamera
from pack_sim.palletizing.overhead_camera import PalletCamera, PalletCameraConfig
from pack_sim.palletizing.simulator import PalletSimulator


class NoiseConfig(Config):
    """Standard deviations of the noise of a detection."""

    position: NonNegativeFloat = Field(default=0.0003, description="along each horizontal axis [m]")
    yaw_deg: NonNegativeFloat = Field(default=0.05, description="about the vertical [deg]")


class BoxFinderConfig(Config):
    """How boxes are detected."""

    by: Literal["vision", "noise"] = "noise"
    latency: NonNegativeFloat = Field(default=0.2, description="from a picture to its detection [s]")
    noise: NoiseConfig = NoiseConfig()
    camera: PalletCameraConfig = PalletCameraConfig()
    vision: VisionConfig = VisionConfig()


class BoxFinder(Protocol):
    """Detects boxes."""

    def detect(self, expected: ExpectedBox, simulator: PalletSimulator) -> BoxDetection:
        """The detection of the expected box at the present time."""


class NoisyBoxFinder:
    """Detects boxes by their true pose, with Gaussian noise.

    Args:
        config: standard deviations of the noise.
        rng: generator of the noise.
    """

    def __init__(self, config: NoiseConfig, rng: np.random.Generator) -> None:
        self._config, self._rng = config, rng

    def detect(self, expected: ExpectedBox, simulator: PalletSimulator) -> BoxDetection:
        """A detection at the box's true pose plus noise; the size is the expected one."""
        state = simulator.truth().objects.get(expected.id)
        if state is None:
            reason = f"box '{expected.id}' is not there"
            return BoxDetection(
                simulator.time, expected.id, DetectionStatus.NOT_FOUND, reason, None, None, (0.0, 0.0)
            )
        X_WB = state.X_WO
        offset = np.array([*self._rng.normal(0.0, self._config.position, 2), 0.0])
        yaw = np.deg2rad(self._rng.normal(0.0, self._config.yaw_deg))
        seen = Pose(X_WB.p + offset, multiply(from_yaw(yaw), X_WB.q))
        size = (expected.dims[0], expected.dims[1])
        return BoxDetection(simulator.time, expected.id, DetectionStatus.DETECTED, "", seen, None, size)


class CameraBoxFinder:
    """Takes a picture and detects the box in it.

    Args:
        camera: draws the pictures.
        table: detects boxes in pictures.
    """

    def __init__(self, camera: PalletCamera, table: TableCamera) -> None:
        self._camera, self._table = camera, table

    def detect(self, expected: ExpectedBox, simulator: PalletSimulator) -> BoxDetection:
        """The detection of box vision in a picture of the present state."""
        picture = self._camera.picture(simulator.snapshot())
        return self._table.detect(picture, expected, simulator.time).detection


@contextmanager
def open_box_finder(
    cell: PalletizingCell, config: BoxFinderConfig, simulator: PalletSimulator, rng: np.random.Generator
) -> Iterator[BoxFinder]:
    """Open the configured box finder.

    Args:
        cell: the cell as it is known.
        config: how boxes are detected.
        simulator: has the cell as it truly is, which the camera sees.
        rng: generates the noise where there are no pictures.

    Raises:
        PackError: pictures are wanted and there is no OpenGL to draw with.
    """
    if config.by == "noise":
        yield NoisyBoxFinder(config.noise, rng)
        return
    with simulator.open_camera(config.camera) as camera:
        known = cell.overhead_camera.scaled(config.camera.width)
        yield CameraBoxFinder(camera, TableCamera(cell, BoxVision(config.vision), known))
