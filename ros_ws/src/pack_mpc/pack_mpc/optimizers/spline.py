"""Twist splines: the held object's twist at a few knots in time, as references of servos and as setpoints."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pack_core.joints import Setpoints
from pack_core.kinematics.damping import damped_inverse
from pack_core.robots.arm_drive import ArmDrive
from pack_core.rotations import Array
from pack_mpc.plant import PackingPlant

NULL_SPACE_RATE = 0.5
"""Rate at which the redundant motion returns to the middle of its range [1/s], slow against the horizon."""
BENDING_RATE = 0.2
"""Rate at which an elbow that is stretched too far is bent again [rad/s]. No twist counts against it: it
draws an object 0.5 m from the elbow along at 0.1 m/s, where `speed_landing` allows 0.07 m/s."""
LEAD_MIN = 1e-9
"""Guards the division by the lead of a reference that stands where the arm does [m]."""


@dataclass(frozen=True)
class Basis:
    """Linear interpolation between knots.

    Attributes:
        times: times of the T steps of the horizon `(T,)` [s].
        knots: times of the K knots `(K,)` [s].
    """

    times: Array
    knots: Array

    def matrix(self) -> Array:
        """Weights `(T, K)` of the knots at each step; the last knot holds on."""
        return _hat(self.times, self.knots)

    def shifted(self, theta: Array, shift: float) -> Array:
        """Knot values `(K, 6)` of the same spline seen `shift` [s] later."""
        return np.asarray(_hat(self.knots + shift, self.knots) @ theta)


def _hat(times: Array, knots: Array) -> Array:
    """Hat functions `(T, K)`: column k is 1 at knot k, 0 at the other knots and linear between them."""
    return np.stack([np.interp(times, knots, row) for row in np.eye(len(knots))], axis=1)


@dataclass(frozen=True)
class ServoReference:
    """Joint positions that the servos of the model were led along by a plan.

    Attributes:
        time: of the first row [s].
        offsets: of each row from `time` `(T,)` [s].
        q: `(T, 7)` [rad].
    """

    time: float
    offsets: Array
    q: Array

    def at(self, time: float, q: Array) -> Array:
        """Where the reference stands at `time` [s], `(7,)` [rad]; at the arm's own `q` if it has run out."""
        if not 0.0 <= time - self.time <= self.offsets[-1]:
            return np.asarray(q)
        return np.array([np.interp(time - self.time, self.offsets, column) for column in self.q.T])


class ResolvedRateServo:
    """Resolved-rate control (Whitney 1969): joint references that give the held object a twist V.

    With the damped pseudo-inverse J^+ = J' (J J' + d I)^-1, taken at one state for the whole horizon,

        dq/dt = J^+ V + k (I - J^+ J) (q_middle - q)

    whose last term uses the seventh joint, which the twist leaves free; q is the integral, within limits that
    keep the elbow bent (`ArmDrive.bent`).

    Args:
        plant: the model with servos.
        q: joint positions at that state `(7,)` [rad].
        q_ref: joint positions at which the reference stands `(7,)` [rad].
        leash: lead limit: how far the reference may be ahead of the arm, measured at the held object [m].
    """

    def __init__(self, plant: PackingPlant, q: Array, q_ref: Array, leash: float) -> None:
        self._limits = plant.arm.limits
        self._q, self._bent = q, plant.bent
        self._J = plant.held_jacobian(q)
        self._inverse = damped_inverse(self._J)
        self._posture = NULL_SPACE_RATE * (np.eye(7) - self._inverse @ self._J) @ (self._limits.middle - q)
        self._start = q + _limited(q_ref - q, self._J, leash)

    def references(self, twists: Array, timestep: float) -> tuple[Array, Array]:
        """Desired positions and velocities `(B, T, 7)` for twists `(B, T, 6)`, linear then angular."""
        limits = self._limits
        v = np.clip(twists @ self._inverse.T + self._posture, -limits.velocity, limits.velocity)
        # The integral up to the beginning of each step: v itself is what happens during the step.
        q = self._start + timestep * (np.cumsum(v, axis=1) - v)
        # An elbow that is stretched further than that is bent again at a rate, not at once.
        back = BENDING_RATE * timestep * np.arange(q.shape[1])[:, None]
        lower = np.maximum(limits.lower, np.minimum(self._bent[0], self._q + back))
        upper = np.minimum(limits.upper, np.maximum(self._bent[1], self._q - back))
        # A velocity that leads on out of the limits would push there against the position.
        v = np.where(q < lower, np.maximum(v, 0.0), np.where(q > upper, np.minimum(v, 0.0), v))
        return np.clip(q, lower, upper), v


def _limited(lead: Array, J: Array, limit: float) -> Array:
    """The lead `(7,)` [rad] of the reference, scaled so that the held object leads by at most `limit` [m].

    The servos press the harder on an obstacle the further the reference leads.
    """
    length = float(np.linalg.norm(J[:3] @ lead))
    return lead * min(1.0, limit / max(length, LEAD_MIN))


def predicted_setpoints(
    plant: PackingPlant, drive: ArmDrive, offsets: Array, xs: Array, q_des: Array, v_des: Array
) -> Setpoints:
    """State a rollout of the servo model as predicted states with feed-forward torques.

    In the rollout the servos pull the arm towards a reference (q_des, v_des), which leads it where it
    pushes. Their torque along the predicted motion (q, v) is

        tau_ff = Kp (q_des - q) + Kd (v_des - v)

    and a driver that adds Kp (q - q_measured) + Kd (v - v_measured), Eq. 4, exerts the torque of the
    servos wherever the arm really is: the predicted state cancels. Both are linear in the rows, so this
    holds between them, too.

    Args:
        plant: the model of the rollout.
        drive: gains Kp and Kd of the servos in it.
        offsets: of the rows from the start `(T,)` [s].
        xs: predicted full states `(T, nx)`.
        q_des: reference positions `(T, 7)` [rad].
        v_des: reference velocities `(T, 7)` [rad/s].

    Returns:
        Setpoints within the limits of the arm.
    """
    limits = plant.arm.limits
    q = np.clip(xs[:, plant.layout.q], limits.lower, limits.upper)
    v = np.clip(xs[:, plant.layout.v], -limits.velocity, limits.velocity)
    tau = np.array(drive.stiffness) * (q_des - q) + np.array(drive.damping) * (v_des - v)
    return Setpoints(float(xs[0, 0]), offsets, q, v, np.clip(tau, -limits.effort, limits.effort))
