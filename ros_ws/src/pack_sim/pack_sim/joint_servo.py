"""Joint controller of an arm: PD position loops, inverse dynamics of the reference, and a slow integral."""

from __future__ import annotations

from collections.abc import Sequence

import mujoco
import numpy as np

from pack_core.robots.joint_properties import JointLimits, JointServoGains
from pack_core.rotations import Array


class JointServo:
    """Turns a reference into torques: tau = kp e + kd de/dt + ID(q_d, v_d, a_d) + integral of e.

    Args:
        model: a model of only the arm, its tool and the load it carries.
        limits: limits of the joints; their names are those in the model.
        servo: the gains.
        timestep: time between two calls of `torque` [s].
    """

    def __init__(
        self, model: mujoco.MjModel, limits: JointLimits, servo: JointServoGains, timestep: float
    ) -> None:
        self._model, self._data = model, mujoco.MjData(model)
        joints = [model.joint(name) for name in limits.names]
        self._q = in_a_row([joint.qposadr[0] for joint in joints])
        self._v = in_a_row([joint.dofadr[0] for joint in joints])
        self._kp, self._kd = servo.stiffness, servo.damping
        self._rate = servo.integral_rate * timestep
        self._effort = limits.effort
        self._most = servo.integral_limit * limits.effort
        self._integral = np.zeros(len(limits))

    def torque(self, q: Array, v: Array, desired: tuple[Array, Array, Array]) -> Array:
        """Joint torques `(n,)` [N m], within the limits.

        Args:
            q: measured positions `(n,)` [rad].
            v: measured velocities `(n,)` [rad/s].
            desired: positions, velocities and accelerations, each `(n,)`.
        """
        q_d, v_d, a_d = desired
        pull = self._kp * (q_d - q)
        self._integral = _clip(self._integral + self._rate * pull, self._most)
        tau = pull + self._kd * (v_d - v) + self._inverse_dynamics(q_d, v_d, a_d) + self._integral
        return _clip(tau, self._effort)

    def _inverse_dynamics(self, q: Array, v: Array, a: Array) -> Array:
        """Torques `(n,)` [N m] that move the arm along the reference, weight included."""
        data = self._data
        data.qpos[self._q], data.qvel[self._v], data.qacc[self._v] = q, v, a
        mujoco.mj_inverse(self._model, data)
        return np.asarray(data.qfrc_inverse[self._v])


def _clip(values: Array, most: Array) -> Array:
    """Values between `-most` and `most`; numpy's `clip` takes twice as long, and this runs in every step."""
    return np.minimum(np.maximum(values, -most), most)


def in_a_row(addresses: Sequence[int]) -> slice | list[int]:
    """Addresses in an array of MuJoCo's, as a slice where they rise by one, which takes numpy a fourth."""
    first = int(addresses[0])
    if list(addresses) == list(range(first, first + len(addresses))):
        return slice(first, first + len(addresses))
    return [int(address) for address in addresses]
