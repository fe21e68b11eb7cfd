"""How a real palletizing cell differs from its configuration: displaced things, soft gears, a real camera."""

from __future__ import annotations

from typing import Annotated

import numpy as np
import numpy.typing as npt
from pydantic import Field, NonNegativeFloat, PositiveFloat

from pack_core.camera import LensDistortion
from pack_core.config import Config
from pack_core.robots.joint_properties import Gears
from pack_core.rotations import Array, Pose, exp, log

Share = Annotated[float, Field(ge=0, lt=1)]
Range = tuple[NonNegativeFloat, NonNegativeFloat]
Vector = Annotated[tuple[float, float, float], Field(description="along x, y and z of the world")]


class Displacement(Config):
    """How far a thing stands from its nominal place: it is turned about its own middle, then shifted."""

    shift: Vector = (0.0, 0.0, 0.0)
    """Displacement of its middle [m]."""
    turn: Vector = (0.0, 0.0, 0.0)
    """Rotation vector about its middle [rad]."""

    @property
    def is_zero(self) -> bool:
        """Whether the thing stands at its nominal place."""
        return not any(self.shift) and not any(self.turn)

    @classmethod
    def of(cls, vector: npt.ArrayLike) -> Displacement:
        """The displacement with shift and turn in one vector `(6,)` [m, rad]."""
        x, y, z, a, b, c = (float(value) for value in np.asarray(vector, dtype=float))
        return cls(shift=(x, y, z), turn=(a, b, c))

    @classmethod
    def between(cls, nominal: Pose, displaced: Pose, middle: npt.ArrayLike) -> Displacement:
        """The displacement that takes a frame of the thing from one pose to another, middle `(3,)` [m]."""
        moved, p = displaced @ nominal.inverse(), np.asarray(middle, dtype=float)
        return cls.of([*(moved.apply(p) - p), *log(moved.q)])

    @property
    def vector(self) -> Array:
        """Shift and turn `(6,)` [m, rad]."""
        return np.array([*self.shift, *self.turn])

    def about(self, middle: npt.ArrayLike) -> Pose:
        """The transform that takes nominal points of the world to the displaced ones, middle `(3,)` [m]."""
        p = np.asarray(middle, dtype=float)
        return Pose(p + np.array(self.shift), exp(self.turn)) @ Pose(-p)

    def applied(self, X_WF: Pose, middle: npt.ArrayLike) -> Pose:
        """Where a frame F that is fixed to the thing is; exactly X_WF where nothing is displaced."""
        return X_WF if self.is_zero else self.about(middle) @ X_WF


NOWHERE = Displacement()
"""Of a thing that stands where it should."""


class PoseError(Config):
    """Size of the error of a pose; its direction is drawn from the seed."""

    position: NonNegativeFloat = 0.0
    """Displacement [m]."""
    orientation_deg: NonNegativeFloat = 0.0
    """Rotation [deg]: of the arm's base about the middle of the cell, of other things about their own."""


class CameraErrors(Config):
    """What a real camera adds to the picture of a pinhole camera, and what of it nobody knows beforehand."""

    pose: PoseError = PoseError()
    """How far it hangs from where it should."""
    focal: NonNegativeFloat = 0.0
    """Largest relative error of the focal length."""
    centre: NonNegativeFloat = 0.0
    """Largest distance of the optical axis from the middle of the picture, in x and in y [pixel]."""
    lens: LensDistortion = LensDistortion()
    """Typical distortion; each coefficient is drawn within `lens_spread` of it."""
    lens_spread: Share = 0.0
    blur: NonNegativeFloat = 0.0
    """Standard deviation of the blur of lens and focus [pixel]."""
    vignetting: Share = 0.0
    """Share of the light that is lost in the corners of the picture."""
    unevenness: Share = 0.0
    """Share by which the light falls from one side of the picture to the other; the side is drawn."""
    full_well: PositiveFloat = 10000.0
    """Electrons of a pixel at the brightest value."""
    exposure: Annotated[float, Field(gt=0, le=1)] = 1.0
    """Share of the full well that is used at the brightest value."""
    read_noise: NonNegativeFloat = 0.0
    """Standard deviation of a pixel in the dark [electrons]."""
    latency: Range = (0.2, 0.2)
    """Shortest and longest time from exposure to detection, evenly distributed [s]."""


class Imperfections(Config):
    """How the real cell differs from the ideal one."""

    gears: Gears | None
    """Elastic gears; None: rigid ones."""
    calibration: PoseError
    """Of the arm's base."""
    furniture: PoseError = PoseError()
    """Of each table and of the pallet."""
    camera: CameraErrors | None = None
    """None: a pinhole camera that hangs where it should."""
    scanners: PoseError = PoseError()
    """Of each scanner, about itself."""
    torque_noise: NonNegativeFloat = 0.0
    """White noise of the measured motor torques, as a share of the published effort."""
    uncalibrated_gap: NonNegativeFloat = 0.0
    """Without a calibration, orders are refused unless boxes are this far apart [m]; 0: no calibration is
    asked for."""
