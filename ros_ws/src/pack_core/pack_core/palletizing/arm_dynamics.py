"""The palletizing cell's arm as its driver knows it: dynamics with load, and gears that give."""

from __future__ import annotations

import mujoco
import numpy as np

from pack_core.palletizing.boxes import BoxBody
from pack_core.palletizing.cell import PalletizingCell
from pack_core.robots.joint_properties import GearCompensation
from pack_core.robots.kr210 import ARMATURE, LIMITS, add_kr210
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
        tool = cell.tool.add_to(add_kr210(spec, cell.arm.X_WB, visuals=False), visuals=False)
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


class DeflectionModel:
    """The lead of the motors before the links, from inverse dynamics and the assumed gears.

    Args:
        load: the controller's model of the arm with what it carries; it may be changed between calls.
        assumed: stiffness and play that are compensated.
    """

    def __init__(self, load: mujoco.MjModel, assumed: GearCompensation) -> None:
        self._model, self._data = load, mujoco.MjData(load)
        self._k = np.array(assumed.stiffness)
        self._play = 0.5 * np.deg2rad(assumed.backlash_deg)
        self._full = assumed.full_load * LIMITS.effort

    def torque(self, q: Array, v: Array, a: Array) -> Array:
        """Torque through the gears `(6,)` [N m] by inverse dynamics, all arguments `(6,)`.

        The motors' own inertia is subtracted, since its torque acts before the gears.
        """
        self._data.qpos[:], self._data.qvel[:], self._data.qacc[:] = q, v, a
        mujoco.mj_inverse(self._model, self._data)
        return np.asarray(self._data.qfrc_inverse - ARMATURE * a)

    def lead(self, q: Array, v: Array, a: Array) -> Array:
        """Angles `(6,)` [rad] by which the motors lead the links: tau / k, and half a loaded gear's play."""
        tau = self.torque(q, v, a)
        return self.lead_under(tau)

    def lead_under(self, tau: Array) -> Array:
        """The lead `(6,)` [rad] under torques through the gears `(6,)` [N m]."""
        return np.asarray(tau / self._k + self._play * np.clip(tau / self._full, -1.0, 1.0))
