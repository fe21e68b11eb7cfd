"""Where the depth cameras of a packing cell hang, as `pack calibrate packing` has found it: its file."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Self

import yaml
from pydantic import NonNegativeFloat, NonNegativeInt, model_validator

from pack_core.calibration_file import load_calibration_of
from pack_core.camera import PinholeCamera
from pack_core.config import Config
from pack_core.errors import ConfigError
from pack_core.packing.depth import DepthCameras, Point
from pack_core.pose_config import PoseConfig


class FoundCamera(Config):
    """One camera."""

    name: str
    pose: PoseConfig
    """X_WC: z forward, x to the right in the picture."""
    shift: Point
    """By which it is off at the container's middle, from where it is seen to where it is [m]."""
    turn: Point
    """Rotation vector between the same [rad]."""
    sigma_shift: NonNegativeFloat
    """Standard deviation of the shift along its worst axis [m]."""
    sigma_turn: NonNegativeFloat
    """Standard deviation of the turn about its worst axis [rad]."""
    residual: NonNegativeFloat
    """Root mean square over the postures of how far the pump is seen from where the joints have it [m]."""
    postures: NonNegativeInt
    """At which it saw the pump."""


class DepthCalibration(Config):
    """Where the depth cameras hang; the arm's base defines the world."""

    preset: str
    """The preset under which the cell was calibrated."""
    described: tuple[PoseConfig, ...]
    """Where the cameras were described to hang, X_WC."""
    cameras: tuple[FoundCamera, ...]
    simulated_s: NonNegativeFloat
    """Time that the calibration took [s]."""

    @model_validator(mode="after")
    def _every_camera_is_found(self) -> Self:
        if len(self.cameras) != len(self.described):
            raise ValueError(
                f"`cameras` has {len(self.cameras)}, `described` {len(self.described)}: needed are as many; "
                "calibrate again, with pack calibrate packing"
            )
        return self

    def applied(self, described: DepthCameras) -> list[PinholeCamera]:
        """The cameras where they hang.

        Raises:
            ConfigError: the file is of other cameras than those described.
        """
        cameras = described.cameras()
        if self.described != tuple(PoseConfig.from_pose(camera.X_WC) for camera in cameras):
            raise ConfigError(
                "the calibration is of cameras that were described elsewhere (`depth.mounts` in "
                "config/cells/packing.yaml has changed since): calibrate again, with pack calibrate packing"
            )
        return [
            replace(camera, X_WC=found.pose.to_pose())
            for camera, found in zip(cameras, self.cameras, strict=True)
        ]

    def write(self, path: Path) -> None:
        """Write its file."""
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(yaml.safe_dump(self.model_dump(mode="json", exclude_none=True), sort_keys=False))


def load_depth_calibration(path: Path) -> DepthCalibration:
    """Read a calibration file; raises ConfigError."""
    return load_calibration_of("packing", DepthCalibration, path)
