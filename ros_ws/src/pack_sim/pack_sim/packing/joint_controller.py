"""Low-level joint controller of the packing cell: setpoints to torques, bounded while there is contact.

Eq. 4 of "Pack it in", with the signs of the errors turned so that it is stable:
`tau = tau_ff + Kp (q_d - q) + Kd (v_d - v)`. Gravity is compensated below this law: the model's own bodies
by MuJoCo, the held object as it is described.
"""

from __future__ import annotations

from collections.abc import Callable

import mujoco
import numpy as np

from pack_core.joints import Desired
from pack_core.packing.model import held_pose
from pack_core.packing.scene import Scene
from pack_core.robots.arm_drive import ArmDrive
from pack_core.rotations import Array
from pack_sim.packing.contact_governor import ContactGovernor

SLIDING = 0.02
"""Speed from which most of the friction is compensated [rad/s]."""


class JointController:
    """Torques that track what is desired of the joints.

    Args:
        robot: the arm with its limits, and the gains.
        governor: limits velocities and torques in contact; None: nothing does.
        friction: friction of each joint, which is compensated in the direction it is driven in [N m].
        torque_step: largest change of a torque from one step to the next while setpoints are tracked [N m].
    """

    def __init__(
        self,
        robot: ArmDrive,
        governor: ContactGovernor | None = None,
        friction: float = 0.0,
        torque_step: float = np.inf,
    ) -> None:
        self._effort = robot.arm.limits.effort
        applied = robot.applied
        self._kp, self._kd = np.array(applied.stiffness), np.array(applied.damping)
        self._kp_hold, self._kd_hold = np.array(robot.stiffness), np.array(robot.damping)
        self._governor, self._friction = governor, friction
        self._torque_step, self._tau = torque_step, np.zeros(len(self._effort))
        self._jacobian: Array | None = None

    @property
    def is_touching(self) -> bool:
        """Whether the governor sees contact, as of the last update."""
        return self._jacobian is not None

    def update_contact(
        self, time: float, force: Array, bending: float, v: Array, J: Callable[[], Array], *, is_holding: bool
    ) -> None:
        """Update the governor with what is measured at the cup.

        Args:
            time: now [s].
            force: external force on the held object `(3,)` [N], in the world frame.
            bending: bending moment on the cup [N m].
            v: joint velocities `(7,)` [rad/s].
            J: returns the cup's Jacobian `(6, 7)`, linear part first, in the world frame.
            is_holding: whether the arm was braked or held in the last step.
        """
        if self._governor is not None:
            is_contact = self._governor.update(time, force, bending, is_holding=is_holding)
            self._jacobian = J() if is_contact else None
            if self._jacobian is not None:
                self._governor.follow(self._jacobian[:3] @ v)

    def torque(self, q: Array, v: Array, desired: Desired, *, is_holding: bool) -> Array:
        """Joint torques `(7,)` [N m], within the limits (Eq. 4).

        Args:
            q: measured positions `(7,)` [rad].
            v: measured velocities `(7,)` [rad/s].
            desired: positions, velocities and feed-forward torques, each `(7,)`.
            is_holding: whether the arm is braked or held, for want of setpoints: with the whole gains.
        """
        q_d, v_d, tau_ff = desired
        if is_holding:  # a stop is not made slower by the bound on the torque's rate
            tau: Array = tau_ff + self._kp_hold * (q_d - q) + self._kd_hold * (v_d - v)
            self._tau = _between(tau, -self._effort, self._effort)
            return self._tau
        tau = tau_ff + self._kp * (q_d - q) + self._kd * (v_d - v)
        # The speed at which the setpoints drive each joint: their own, and that which their torque would
        # bring a joint to against the damping of the model. In contact it is where the arm pushes.
        w_d = v_d + tau_ff / self._kd_hold
        if self._governor is None or self._jacobian is None:
            tau += self._compensation(w_d)
        else:
            slowed = self._governor.slow_down(w_d, self._jacobian)
            tau += self._kd_hold * (slowed - w_d) + self._compensation(slowed)
            tau = self._governor.bound(tau, self._jacobian)
        tau = _between(tau, self._tau - self._torque_step, self._tau + self._torque_step)
        self._tau = _between(tau, -self._effort, self._effort)
        return self._tau

    def _compensation(self, w_d: Array) -> Array:
        """Torque `(7,)` [N m] against the friction of joints that are driven at `w_d` [rad/s]."""
        # tanh instead of the sign: no chattering about a speed of zero
        return np.asarray(self._friction * np.tanh(w_d / SLIDING))


def _between(values: Array, lower: Array, upper: Array) -> Array:
    """What `np.clip` gives, in a fifth of its time for a few values."""
    return np.minimum(np.maximum(values, lower), upper)


class PayloadCompensation:
    """Compensates the described weight of the held object, at its described centre of mass, by joint torques.

    Args:
        model: model of the cell with the object on the cup; weight that the model itself compensates
            (`gravcomp`) is not compensated twice.
        description: the scene as the driver knows it.

    Attributes:
        described_weight: what bears the held object as described, against gravity `(3,)` [N].
    """

    def __init__(self, model: mujoco.MjModel, description: Scene) -> None:
        held = model.body(description.new_object.name).id
        self.described_weight = -description.new_object.mass * model.opt.gravity
        mass = description.new_object.mass - float(model.body_gravcomp[held] * model.body_mass[held])
        self._force, self._no_torque = -mass * model.opt.gravity, np.zeros(3)
        self._is_needed = bool(self._force.any())
        self._tool = model.body("tool").id
        self._p_TC = held_pose(description).apply(description.new_object.centre_of_mass)

    def apply(self, model: mujoco.MjModel, data: mujoco.MjData) -> None:
        """Set the applied torques of the next step."""
        applied = data.qfrc_applied
        applied[:] = 0.0
        if self._is_needed:
            point = data.xpos[self._tool] + data.xmat[self._tool].reshape(3, 3) @ self._p_TC
            mujoco.mj_applyFT(model, data, self._force, self._no_torque, point, self._tool, applied)
