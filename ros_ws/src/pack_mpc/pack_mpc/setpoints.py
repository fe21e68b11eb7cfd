"""Setpoints as the paper's driver takes them: predicted states, and the torques that go with them (Eq. 4)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from pack_core.joints import JointSample, Setpoints
from pack_core.robots.arm_drive import ArmDrive
from pack_core.rotations import Array
from pack_mpc.plant import PackingPlant


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


def pressing(plant: PackingPlant, setpoints: Setpoints, force: float) -> Setpoints:
    """The same setpoints with torques that press the held object down with `force` [N] more.

    A force f on the object takes the joint torques J' f, J the Jacobian of its position where the setpoints
    begin. The torques stay within the arm's limits.
    """
    if not force:
        return setpoints
    limit = plant.arm.limits.effort
    down = plant.held_jacobian(setpoints.q[0])[:3].T @ np.array([0.0, 0.0, -force])
    return replace(setpoints, tau=np.clip(setpoints.fed_forward + down, -limit, limit))


def hold(joints: JointSample) -> Setpoints:
    """Setpoints that run out at once, so that the driver holds the arm where it is."""
    zero = np.zeros((1, 7))
    return Setpoints(joints.time, np.zeros(1), joints.q[None], zero, zero)
