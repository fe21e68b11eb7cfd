"""The state when a plan will be in force: the model, driven as the driver drives the arm."""

from __future__ import annotations

from typing import TYPE_CHECKING

import mujoco
import numpy as np
from pack_core.cells.packing import Robot
from pack_core.rotations import Array

from pack_mpc.plant import STATE, PackingPlant

if TYPE_CHECKING:
    from pack_mpc.controller import Plan


def predict(plant: PackingPlant, robot: Robot, x: Array, plan: Plan | None, latency: float) -> Array:
    """Advance a state by `latency` [s] under the plan in flight (Eq. 4); without a plan the arm holds.

    Args:
        plant: the controller's model.
        robot: the driver's gains.
        x: full state `(nx,)`.
        plan: in flight.
        latency: rounded to whole steps of the model.
    """
    steps = int(round(latency / plant.timestep))
    if steps == 0:
        return x
    data = mujoco.MjData(plant.model)
    mujoco.mj_setState(plant.model, data, x, STATE)
    kp, kd = np.array(robot.stiffness), np.array(robot.damping)
    q_index, v_index = plant.layout.q, plant.layout.v
    q_hold = x[q_index]
    state = x
    for _ in range(steps):
        q_d, v_d, tau = (q_hold, np.zeros(7), np.zeros(7)) if plan is None else _reference(plan, state[0], plant)
        tau = tau + kp * (q_d - state[q_index]) + kd * (v_d - state[v_index])
        data.ctrl[:] = np.clip(tau, -plant.limits, plant.limits)
        mujoco.mj_step(plant.model, data)
        state = np.empty(plant.nx)
        mujoco.mj_getState(plant.model, data, state, STATE)
    return state


def _reference(plan: Plan, time: float, plant: PackingPlant) -> tuple[Array, Array, Array]:
    xs, us = plan.trajectory.xs, plan.trajectory.us
    i = min(max(int(round((time - xs[0, 0]) / plant.timestep)), 0), len(us) - 1)
    return xs[i, plant.layout.q], xs[i, plant.layout.v], us[i]
