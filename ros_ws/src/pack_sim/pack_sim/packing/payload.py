"""Torques that the driver adds to carry the held object as described."""

from __future__ import annotations

import mujoco
import numpy as np

from pack_core.packing.model import held_pose
from pack_core.packing.scene import Scene


class PayloadCompensation:
    """Compensates the described weight of the held object, at its described centre of mass, by joint torques.

    Args:
        model: model of the cell with the object on the cup; weight that the model itself compensates
            (`gravcomp`) is not compensated twice.
        description: the scene as the driver knows it.
    """

    def __init__(self, model: mujoco.MjModel, description: Scene) -> None:
        held = model.body(description.new_object.name).id
        mass = description.new_object.mass - float(model.body_gravcomp[held] * model.body_mass[held])
        self._force = -mass * model.opt.gravity
        self._tool = model.body("tool").id
        self._p_TC = held_pose(description).apply(description.new_object.centre_of_mass)

    def apply(self, model: mujoco.MjModel, data: mujoco.MjData) -> None:
        """Set the applied torques of the next step."""
        data.qfrc_applied[:] = 0.0
        if self._force.any():
            point = data.xpos[self._tool] + data.xmat[self._tool].reshape(3, 3) @ self._p_TC
            mujoco.mj_applyFT(model, data, self._force, np.zeros(3), point, self._tool, data.qfrc_applied)
