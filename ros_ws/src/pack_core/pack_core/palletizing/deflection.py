"""How far the gears of the palletizing arm give under its weight and its load, as its controller assumes."""

from __future__ import annotations

import mujoco
import numpy as np

from pack_core.robots.gears import GearCompensation
from pack_core.robots.kr210 import ARMATURE, LIMITS
from pack_core.rotations import Array


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
