"""The numbers that a calibration finds, what is known of them beforehand, and what they stand for."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pack_core.camera import LensDistortion
from pack_core.palletizing.calibration import CalibratedCamera
from pack_core.palletizing.imperfections import Displacement
from pack_core.robots.joint_properties import GearCompensation
from pack_core.rotations import Array

AXES = ("x", "y", "z", "about x", "about y", "about z")
PLACES = ("picking_table", "reorientation_table", "pallet")
FELT_GEARS = (0, 1, 2, 4)
"""Joints whose stiffness is estimated; 4 and 6 bear next to nothing with the tool pointing down."""


@dataclass(frozen=True)
class Parameter:
    """One number to be found: its name, what is known of it beforehand, and its unit.

    `sigma` is the standard deviation that it has before anything is measured; what nothing shows keeps it.
    """

    name: str
    value: float
    sigma: float
    unit: str


def _pose(name: str, position: float, angle_deg: float) -> list[Parameter]:
    sigmas = [position] * 3 + [float(np.deg2rad(angle_deg))] * 3
    units = ["m"] * 3 + ["rad"] * 3
    rows = zip(AXES, sigmas, units, strict=True)
    return [Parameter(f"{name} {axis}", 0.0, sigma, unit) for axis, sigma, unit in rows]


PARAMETERS: tuple[Parameter, ...] = (
    *_pose("camera", 0.02, 1.0),
    Parameter("camera focal length, share", 1.0, 0.02, "1"),
    Parameter("camera centre u", 0.0, 40.0, "pixel"),
    Parameter("camera centre v", 0.0, 40.0, "pixel"),
    Parameter("lens k1", 0.0, 0.3, "1"),
    Parameter("lens k2", 0.0, 0.3, "1"),
    Parameter("lens p1", 0.0, 0.01, "1"),
    Parameter("lens p2", 0.0, 0.01, "1"),
    *_pose("board in the gripper", 0.03, 3.0),
    *(parameter for place in PLACES for parameter in _pose(place, 0.006, 0.4)),
    *(Parameter(f"compliance of joint {i + 1}, share", 1.0, 0.25, "1") for i in FELT_GEARS),
    Parameter("play of the gears, share of the data sheet", 1.0, 0.3, "1"),
)
"""In the sequence of the vector that is estimated."""
CAMERA, FOCAL, CENTRE, LENS = slice(0, 6), 6, slice(7, 9), slice(9, 13)
BOARD, GEARS, PLAY = slice(13, 19), slice(37, 41), 41
PLACE = {name: slice(19 + 6 * k, 25 + 6 * k) for k, name in enumerate(PLACES)}
"""Where `PARAMETERS` has what: the slices must change with it."""


def lens_of(x: Array) -> LensDistortion:
    """The lens."""
    k1, k2, p1, p2 = (float(value) for value in x[LENS])
    return LensDistortion(k1=k1, k2=k2, p1=p1, p2=p2)


def camera_of(x: Array) -> CalibratedCamera:
    """The camera as it is kept."""
    return CalibratedCamera(
        displacement=Displacement.of(x[CAMERA]), focal_scale=float(x[FOCAL]),
        centre_shift=(float(x[CENTRE][0]), float(x[CENTRE][1])), lens=lens_of(x),
    )  # fmt: skip


def shares_of(x: Array) -> Array:
    """Compliance of every gear as a share of what was assumed `(6,)`."""
    shares = np.ones(6)
    shares[list(FELT_GEARS)] = x[GEARS]
    return shares


def gears_of(x: Array, assumed: GearCompensation, backlash_deg: float) -> GearCompensation:
    """The gears as they are kept; `backlash_deg` is the play of the data sheet [deg]."""
    k = np.array(assumed.stiffness) / shares_of(x)
    stiffness = tuple(float(value) for value in k)
    return assumed.model_copy(update={"stiffness": stiffness, "backlash_deg": backlash_deg * float(x[PLAY])})


def start() -> Array:
    """What is known before anything is measured."""
    return np.array([parameter.value for parameter in PARAMETERS])


def prior_sigmas() -> Array:
    """Standard deviations of that."""
    return np.array([parameter.sigma for parameter in PARAMETERS])
