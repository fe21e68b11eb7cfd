"""What the driver adds to the arm's torques to carry the object that it was told of."""

from __future__ import annotations

import mujoco
import numpy as np

from pack_core.packing.model import held_pose
from pack_core.packing.scene import Scene


class PayloadCompensation:
    """The weight of the object as described, at its described centre, as torques of the arm's joints.

    Args:
        model: of the cell, with the object on the cup; what it compensates by itself is left out.
        description: what the driver believes to hold.
    """

    def __init__(self, model: mujoco.MjModel, description: Scene) -> None:
        held = model.body(description.new_object.name).id
        mass = description.new_object.mass - float(model.body_gravcomp[held] * model.body_mass[held])
        self._force = -mass * model.opt.gravity
        self._tool = model.body("tool").id
        self._p_TN = held_pose(description).p

    def apply(self, model: mujoco.MjModel, data: mujoco.MjData) -> None:
        """Set the applied torques of the next step."""
        data.qfrc_applied[:] = 0.0
        if self._force.any():
            point = data.xpos[self._tool] + data.xmat[self._tool].reshape(3, 3) @ self._p_TN
            mujoco.mj_applyFT(model, data, self._force, np.zeros(3), point, self._tool, data.qfrc_applied)
