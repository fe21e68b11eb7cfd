"""The controller's model of the arm: the dynamics of arm and tool, and of the box that is carried."""

from __future__ import annotations

import mujoco
import numpy as np

from pack_core.palletizing.box_body import BoxBody
from pack_core.palletizing.cell import PalletizingCell
from pack_core.robots.kr210 import add_kr210
from pack_core.rotations import Array, Pose

LOAD = "load"


class CarriedLoad:
    """A model of the arm alone, without friction, with a load under its tool.

    Args:
        cell: the cell's physical facts.
    """

    def __init__(self, cell: PalletizingCell) -> None:
        spec = mujoco.MjSpec()
        spec.compiler.degree = False
        spec.option.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
        tool = cell.tool.add_to(add_kr210(spec, cell.arm.X_WB, look=False), look=False)
        tool.add_body(name=LOAD)
        self.model = spec.compile()

    def put_on(self, box: BoxBody, X_TB: Pose) -> None:
        """Add the mass and inertia of a box held at X_TB."""
        self._set(box.mass, X_TB, box.inertia)

    def take_off(self) -> None:
        """Remove the box from the model."""
        self._set(0.0, Pose(np.zeros(3)), np.zeros(3))

    def _set(self, mass: float, X_TB: Pose, inertia: Array) -> None:
        body = self.model.body(LOAD).id
        self.model.body_mass[body], self.model.body_inertia[body] = mass, inertia
        self.model.body_ipos[body], self.model.body_iquat[body] = X_TB.p, X_TB.q
        mujoco.mj_setConst(self.model, mujoco.MjData(self.model))  # recomputes what depends on the masses
