"""What stands in for the camera: the truth with stated noise."""

from __future__ import annotations

import numpy as np
from pydantic import Field, NonNegativeFloat

from pack_core.box_detection import BoxDetection, DetectionStatus, ExpectedBox
from pack_core.config import Config
from pack_core.rotations import Pose, from_yaw, multiply


class NoisySightConfig(Config):
    """Noise of a detection, one standard deviation."""

    position: NonNegativeFloat = Field(default=0.0003, description="along each horizontal axis [m]")
    yaw_deg: NonNegativeFloat = Field(default=0.05, description="about the vertical [deg]")


class NoisySight:
    """Sees boxes where they are, and a little beside.

    Args:
        config: the noise.
        rng: its source.
    """

    def __init__(self, config: NoisySightConfig, rng: np.random.Generator) -> None:
        self._config, self._rng = config, rng

    def detect(self, expected: ExpectedBox, X_WB: Pose, time: float) -> BoxDetection:
        """A detection of the box that truly stands at X_WB."""
        offset = np.array([*self._rng.normal(0.0, self._config.position, 2), 0.0])
        yaw = np.deg2rad(self._rng.normal(0.0, self._config.yaw_deg))
        seen = Pose(X_WB.p + offset, multiply(from_yaw(yaw), X_WB.q))
        size = (expected.dims[0], expected.dims[1])
        return BoxDetection(time, expected.id, DetectionStatus.DETECTED, "", seen, None, size)
