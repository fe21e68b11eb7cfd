"""Twist splines: the held object's twist at a few knots, turned into joint references."""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np

from pack_core.rotations import Array
from pack_mpc.plant import STATE, PackingPlant

DAMPING = 1e-4
NULL_SPACE_RATE = 0.5
"""Rate at which the redundant joint motion returns to the middle of its range [1/s]."""


@dataclass(frozen=True)
class Basis:
    """Linear interpolation of knots.

    Attributes:
        times: of the steps `(T,)` [s].
        knots: times of the knots `(K,)` [s].
    """

    times: Array
    knots: Array

    def matrix(self, shift: float = 0.0) -> Array:
        """Weights `(T, K)` of the knots at each step, `shift` [s] later; held beyond the last knot."""
        return _hat(self.times + shift, self.knots)

    def shifted(self, theta: Array, shift: float) -> Array:
        """Knot values `(K, 6)` of the same spline seen `shift` [s] later."""
        return np.asarray(_hat(self.knots + shift, self.knots) @ theta)


def _hat(times: Array, knots: Array) -> Array:
    return np.stack([np.interp(times, knots, row) for row in np.eye(len(knots))], axis=1)


class ResolvedRateServo:
    """Joint references around one state: `qd = J^+ twist + null-space motion`, q its integral.

    Args:
        plant: the model with servos.
        x0: full state `(nx,)`.
        q_ref: where the reference stood `(7,)` [rad].
        leash: how far the reference may be ahead of the arm, at the held object [m].
    """

    def __init__(self, plant: PackingPlant, x0: Array, q_ref: Array, leash: float) -> None:
        self._limits = plant.arm.limits
        model, data = plant.model, mujoco.MjData(plant.model)
        mujoco.mj_setState(model, data, x0, STATE)
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        jacobian = np.zeros((6, model.nv))
        body = model.body(plant.scene.new_object.name).id
        mujoco.mj_jacBody(model, data, jacobian[:3], jacobian[3:], body)
        self._J = jacobian[:, plant.layout.v - 1 - model.nq]
        self._inverse = self._J.T @ np.linalg.inv(self._J @ self._J.T + DAMPING * np.eye(6))
        q = x0[plant.layout.q]
        self._posture = NULL_SPACE_RATE * (np.eye(7) - self._inverse @ self._J) @ (self._limits.middle - q)
        self._start = q + _leashed(q_ref - q, self._J, leash)

    def references(self, twists: Array, timestep: float) -> tuple[Array, Array]:
        """Desired positions and velocities `(B, T, 7)` for twists `(B, T, 6)`, linear then angular."""
        limits = self._limits
        v = np.clip(twists @ self._inverse.T + self._posture, -limits.velocity, limits.velocity)
        q = self._start + timestep * (np.cumsum(v, axis=1) - v)
        return np.clip(q, limits.lower, limits.upper), v


def _leashed(lead: Array, J: Array, leash: float) -> Array:
    """The lead `(7,)` of the reference, shortened so that the held object's is at most `leash`."""
    length = float(np.linalg.norm(J[:3] @ lead))
    return lead * min(1.0, leash / max(length, 1e-9))
