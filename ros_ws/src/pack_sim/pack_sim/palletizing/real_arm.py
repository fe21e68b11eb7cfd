"""How the real arm differs from the ideal one: elastic gears with play, and an error of its calibration."""

from __future__ import annotations

import mujoco
import numpy as np

from pack_core.palletizing.arm_dynamics import DeflectionModel
from pack_core.palletizing.cell import PalletizingCell
from pack_core.robots.joint_properties import GearCompensation, Gears
from pack_core.rotations import Array, Pose, exp


def true_base(cell: PalletizingCell, seed: int) -> Pose:
    """The true X_WB of the arm's base: displaced and turned about the middle of the cell at random.

    Directions are drawn from the seed; the sizes of both errors are those of the cell's calibration.
    """
    rng = np.random.default_rng([seed, 1])
    shift, axis = (_direction(rng) for _ in range(2))
    calibration = cell.imperfections.calibration
    tables = (cell.picking_table, cell.reorientation_table)
    places = [*(np.array([*table.centre, table.height]) for table in tables), cell.pallet.X_WP.p]
    middle = Pose(np.mean(places, axis=0))
    error = Pose(calibration.position * shift, exp(np.deg2rad(calibration.orientation_deg) * axis))
    # The base is turned about the middle between tables and pallet, not about itself.
    return middle @ error @ middle.inverse() @ cell.arm.X_WB


class GearTrain:
    """The springs between motors and links, and how the controller compensates them.

    Args:
        gears: stiffness and play.
        load: the controller's model of the arm with its load.
        assumed: what the controller assumes of the gears; by default what the preset says.
    """

    def __init__(self, gears: Gears, load: mujoco.MjModel, assumed: GearCompensation | None = None) -> None:
        self._k = np.array(gears.stiffness)
        self._play = 0.5 * np.deg2rad(gears.backlash_deg)
        self._lead = DeflectionModel(load, assumed or gears.assumed)
        self._reports_links = gears.reports_links
        self.lead = np.zeros(6)
        """By how much the motors lead the links, as the controller assumes `(6,)` [rad]."""

    def torque(self, deflection: Array) -> Array:
        """Torque `(6,)` [N m] of the springs at the links' deflection `(6,)` [rad]; none within the play."""
        beyond = deflection - np.clip(deflection, -self._play, self._play)
        return -self._k * beyond

    def motors(self, desired: tuple[Array, Array, Array]) -> tuple[Array, Array, Array]:
        """The motors' reference for the links' desired one: q + tau / k, ahead by the springs' deflection.

        tau is the torque through the gears by inverse dynamics. The motors' own inertia is subtracted, since
        its torque acts before the gears.
        """
        q, v, a = desired
        lead = self._lead.lead(q, v, a)
        if self._reports_links:
            self.lead = lead
        return q + lead, v, a


def _direction(rng: np.random.Generator) -> Array:
    v = rng.normal(size=3)
    return np.asarray(v / np.linalg.norm(v))
