"""How what is measured depends on what is to be found."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pack_core.camera import LensDistortion, PinholeCamera, seen_pixels
from pack_core.kinematics.chain import SerialChain
from pack_core.palletizing.calibration import CalibratedCamera
from pack_core.palletizing.calibration_board import CALIBRATION_BOARD
from pack_core.palletizing.cell import BoxTable, PalletizingCell, PalletPlace
from pack_core.palletizing.deflection import DeflectionModel
from pack_core.palletizing.displacement import Displacement
from pack_core.robots.gears import GearCompensation
from pack_core.robots.kr210 import LIMITS
from pack_core.rotations import Array, Pose, exp, multiply, rotate
from pack_lockstep.palletizing.calibration.measurements import BoardView, Contact
from pack_sim.palletizing.carried_load import CarriedLoad

PLACES = ("picking_table", "reorientation_table", "pallet")
FELT_GEARS = (0, 1, 2, 4)
"""Joints whose stiffness is estimated; 4 and 6 bear next to nothing with the tool pointing down."""
SETTLING = 0.003
"""Load from which a gear at rest lies at one side of its play, as a share of the effort."""
LEAST_LEVER = 0.05
"""Joints with a shorter lever do not feel a touch [m]."""
CORNERS = CALIBRATION_BOARD.corners()
AXES = ("x", "y", "z", "about x", "about y", "about z")


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


@dataclass(frozen=True)
class Sag:
    """How the links may differ from what the driver reports.

    Attributes:
        q: reported joints `(6,)` [rad].
        lead: by how much the driver assumed the motors to lead the links, by elasticity `(6,)` [rad].
        play: by how much they lead them beyond that if the play is what the data sheet says `(6,)` [rad].
    """

    q: Array
    lead: Array
    play: Array

    def links(self, x: Array) -> Array:
        """Angles of the links `(6,)` for a vector of parameters."""
        return np.asarray(self.q + self.lead * (1.0 - shares_of(x)) - x[PLAY] * self.play)


class CellModel:
    """Predicts measurements.

    Args:
        cell: the cell as it is known before the calibration.
        arm: kinematics of its arm.
        assumed: what the driver assumed of the gears while it was measured.
        X_TB: nominal pose of the board in the gripper.
    """

    def __init__(
        self, cell: PalletizingCell, arm: SerialChain, assumed: GearCompensation, X_TB: Pose
    ) -> None:
        self.cell, self.arm, self.assumed, self.X_TB = cell, arm, assumed, X_TB
        gears = cell.imperfections.gears
        self.backlash_deg = 0.0 if gears is None else gears.backlash_deg
        self._half_play = 0.5 * float(np.deg2rad(self.backlash_deg))
        load = CarriedLoad(cell)
        self._empty = DeflectionModel(load.model, assumed)
        carrying = CarriedLoad(cell)
        carrying.put_on(CALIBRATION_BOARD.body, X_TB)
        self._loaded = DeflectionModel(carrying.model, assumed)

    def sag(self, q: Array, *, loaded: bool, push: Array | None = None) -> Sag:
        """What differs at reported joints `(6,)` at rest.

        Args:
            q: reported joints.
            loaded: whether the board is held.
            push: torques `(6,)` for a unit force on something that is touched. They take up the play of the
                gears that weight does not load: the touch is felt when it is taken up.
        """
        rest = np.zeros(6)
        model = self._loaded if loaded else self._empty
        tau = model.torque(q, rest, rest)
        side = np.clip(tau / (SETTLING * LIMITS.effort), -1.0, 1.0)
        if push is not None:
            felt = (np.abs(side) < 1.0) & (np.abs(push) > LEAST_LEVER)
            side = np.where(felt, np.sign(push), side)
        return Sag(q, tau / np.array(self.assumed.stiffness), self._half_play * side)

    def known(self, x: Array) -> PalletizingCell:
        """The cell with the values of a vector of parameters."""
        camera = camera_of(x).model_dump()
        places = {
            name: getattr(self.cell, name).model_copy(
                update={"displacement": Displacement.of(x[PLACE[name]])}
            )
            for name in PLACES
        }
        mount = self.cell.camera.model_copy(
            update={**{k: camera[k] for k in ("focal_scale", "centre_shift")},
                    "displacement": Displacement.of(x[CAMERA]), "lens": lens_of(x)}
        )  # fmt: skip
        return self.cell.model_copy(update={**places, "camera": mount})

    def board(self, x: Array) -> Pose:
        """X_TB of the board."""
        shift, turn = x[BOARD][:3], x[BOARD][3:]
        return Pose(self.X_TB.p + shift, multiply(self.X_TB.q, exp(turn)))

    def pixels(self, x: Array, views: Sequence[tuple[BoardView, Array]]) -> list[Array]:
        """Where the corners of views should be seen, each `(n, 2)`, the links being at `q` `(6,)` in each."""
        camera, lens, X_TB = self.known_camera(x), lens_of(x), self.board(x)
        return [
            seen_pixels(camera, lens, (self.arm.forward(q) @ X_TB).apply(CORNERS[view.ids]))
            for view, q in views
        ]

    def known_camera(self, x: Array) -> PinholeCamera:
        """The camera without distortion."""
        mount = self.cell.camera.model_copy(
            update={
                "displacement": Displacement.of(x[CAMERA]), "focal_scale": float(x[FOCAL]),
                "centre_shift": (float(x[CENTRE][0]), float(x[CENTRE][1])),
            }
        )  # fmt: skip
        return self.cell.model_copy(update={"camera": mount}).overhead_camera

    def gap(self, x: Array, contact: Contact, q: Array) -> float:
        """Distance of the touching corner from the surface along its axis [m]; 0 for the true parameters."""
        touch = contact.touch
        p_WC = self.arm.forward(q).apply(touch.p_TC)
        place: BoxTable | PalletPlace = getattr(self.cell, touch.what)
        shift, turn = x[PLACE[touch.what]][:3], x[PLACE[touch.what]][3:]
        # The nominal point N of a displaced one: p = middle + shift + R (N - middle).
        p_N = place.middle + rotate(exp(-turn), p_WC - place.middle - shift)
        return float(p_N[touch.axis] - touch.at)

    def give(self, x: Array, contact: Contact) -> float:
        """By how much the tool should give at a touch [m]."""
        return float(contact.bears @ (shares_of(x) / np.array(self.assumed.stiffness)))


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


def sag_at(model: CellModel, contact: Contact) -> Sag:
    """The sag at a touch."""
    J = model.arm.with_tool(Pose(contact.touch.p_TC)).jacobian(contact.q)[:3]
    return model.sag(contact.q, loaded=False, push=contact.touch.normal @ J)
