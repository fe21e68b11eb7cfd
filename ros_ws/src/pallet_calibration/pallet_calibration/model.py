"""How what is measured depends on what is to be found."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pack_core.camera import PinholeCamera, seen_pixels
from pack_core.kinematics.chain import SerialChain
from pack_core.palletizing.arm_dynamics import CarriedLoad, DeflectionModel
from pack_core.palletizing.calibration_board import CALIBRATION_BOARD
from pack_core.palletizing.cell import BoxTable, PalletizingCell, PalletPlace
from pack_core.palletizing.imperfections import Displacement
from pack_core.robots.joint_properties import GearCompensation
from pack_core.robots.kr210 import LIMITS
from pack_core.rotations import Array, Pose, exp, multiply, rotate
from pallet_calibration.measurements import BoardView, FeltContact
from pallet_calibration.parameters import (
    BOARD,
    CAMERA,
    CENTRE,
    FOCAL,
    PLACE,
    PLACES,
    PLAY,
    camera_of,
    lens_of,
    shares_of,
)

SETTLING = 0.003
"""Load from which a gear at rest lies at one side of its play, as a share of the effort."""
LEAST_LEVER = 0.05
"""Joints with a shorter lever do not feel a touch [m]."""
CORNERS = CALIBRATION_BOARD.corners()


@dataclass(frozen=True)
class Sag:
    """How the links may differ from what the driver reports.

    Attributes:
        q: reported joints `(6,)` [rad].
        lead: by how much the driver took the motors to lead the links `(6,)` [rad].
        give: by how much they lead them by elasticity if that is what the data sheet says `(6,)` [rad].
        play: by how much they lead them beyond that if the play is, too `(6,)` [rad].
    """

    q: Array
    lead: Array
    give: Array
    play: Array

    def links(self, x: Array) -> Array:
        """Angles of the links `(6,)` for a vector of parameters."""
        return np.asarray(self.q + self.lead - self.give * shares_of(x) - x[PLAY] * self.play)


class CellModel:
    """Predicts measurements.

    Args:
        cell: the cell as it is known before the calibration.
        arm: kinematics of its arm.
        assumed: the gears by their data sheet, of which shares are estimated.
        X_TB: nominal pose of the board in the gripper.
        driver: what the driver compensated while it was measured; by default the data sheet's.
    """

    def __init__(
        self, cell: PalletizingCell, arm: SerialChain, assumed: GearCompensation, X_TB: Pose,
        driver: GearCompensation | None = None,
    ) -> None:  # fmt: skip
        self.cell, self.arm, self.assumed, self.X_TB = cell, arm, assumed, X_TB
        gears = cell.imperfections.gears
        self.backlash_deg = 0.0 if gears is None else gears.backlash_deg
        self._half_play = 0.5 * float(np.deg2rad(self.backlash_deg))
        load = CarriedLoad(cell)
        self._empty = DeflectionModel(load.model, driver or assumed)
        carrying = CarriedLoad(cell)
        carrying.put_on(CALIBRATION_BOARD.body, X_TB)
        self._loaded = DeflectionModel(carrying.model, driver or assumed)

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
        give = tau / np.array(self.assumed.stiffness)
        return Sag(q, model.lead_under(tau), give, self._half_play * side)

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

    def gap(self, x: Array, contact: FeltContact, q: Array) -> float:
        """Distance of the touching corner from the surface along its axis [m]; 0 for the true parameters."""
        touch = contact.touch
        p_WC = self.arm.forward(q).apply(touch.p_TC)
        place: BoxTable | PalletPlace = getattr(self.cell, touch.what)
        shift, turn = x[PLACE[touch.what]][:3], x[PLACE[touch.what]][3:]
        # The nominal point N of a displaced one: p = middle + shift + R (N - middle).
        p_N = place.middle + rotate(exp(-turn), p_WC - place.middle - shift)
        return float(p_N[touch.axis] - touch.at)

    def give(self, x: Array, contact: FeltContact) -> float:
        """By how much the tool should give at a touch [m]."""
        return float(contact.bears @ (shares_of(x) / np.array(self.assumed.stiffness)))


def sag_at(model: CellModel, contact: FeltContact) -> Sag:
    """The sag at a touch."""
    J = model.arm.with_tool(Pose(contact.touch.p_TC)).jacobian(contact.q)[:3]
    return model.sag(contact.q, loaded=False, push=contact.touch.normal @ J)
