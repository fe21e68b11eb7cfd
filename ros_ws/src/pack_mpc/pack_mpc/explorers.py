"""Explorers: variations of a plan that move the held object aside or tilt it and come to rest again.

A flat landing on top of an obstacle is a local minimum: pressing down changes nothing, and the
gradient does not see the gap a few centimetres away. Rolled out beside the line search, an explorer
that drops into the gap costs less and becomes the next plan; the optimizer refines it.
"""

from __future__ import annotations

import mujoco
import numpy as np
from pydantic import Field, NonNegativeFloat, NonNegativeInt

from pack_core.config import Config
from pack_core.rotations import Array
from pack_mpc.plant import STATE, PackingPlant


class ExplorerConfig(Config):
    """How far explorers go; displacements are drawn from normal distributions."""

    count: NonNegativeInt = Field(default=5, description="explorers an iteration, in INSERT")
    sideways: NonNegativeFloat = Field(default=0.04, description="deviation along x and y [m]")
    up: NonNegativeFloat = Field(default=0.02, description="deviation along z [m]")
    tilt: NonNegativeFloat = Field(default=0.25, description="deviation of the tilt about x and y [rad]")


def explore(
    plant: PackingPlant, x0: Array, us: Array, away: Array, config: ExplorerConfig, rng: np.random.Generator
) -> Array:
    """Variations `(E, T, 7)` of the torques `us` `(T, 7)`.

    Half of them lean the held object over the obstacles, its lower end `away` `(2,)` from them.

    Each adds the torque of one smooth displacement d of the held object, whose acceleration is a full
    period of a sine, so that it starts and ends at rest; the inertia is the arm's at `x0`.
    """
    deviation = np.array([config.sideways] * 2 + [config.up] + [config.tilt] * 2 + [0.0])
    d = rng.normal(size=(config.count, 6)) * deviation
    d[::2] = _lean(d[::2], away, float(plant.scene.new_object.half_extents[2]))
    steps = len(us)
    durations = rng.uniform(0.4, 1.0, config.count) * steps
    phase = np.arange(steps) / durations[:, None]
    profile = np.where(phase < 1.0, np.sin(2 * np.pi * phase), 0.0)
    peak = 2 * np.pi * d / (durations[:, None] * plant.timestep) ** 2
    acceleration = profile[..., None] * peak[:, None]
    torques = us + acceleration @ _torque_per_acceleration(plant, x0)
    return np.asarray(np.clip(torques, -plant.limits, plant.limits))


def _lean(d: Array, away: Array, half_height: float) -> Array:
    """Turn displacements `(n, 6)` into tilts about the object's lower edge, its top over the obstacles."""
    leaned, tilt = d.copy(), np.abs(d[:, 3:4])
    leaned[:, :2] = 0.5 * d[:, :2] - half_height * tilt * away
    leaned[:, 3:5] = tilt * np.array([away[1], -away[0]])
    return leaned


def _torque_per_acceleration(plant: PackingPlant, x0: Array) -> Array:
    """Joint torques for unit accelerations of the held object, linear then angular: `(6, 7)`."""
    model, data = plant.model, mujoco.MjData(plant.model)
    mujoco.mj_setState(model, data, x0, STATE)
    mujoco.mj_forward(model, data)
    jacobian, inertia = np.zeros((6, model.nv)), np.zeros((model.nv, model.nv))
    body = model.body(plant.scene.new_object.name).id
    mujoco.mj_jacBody(model, data, jacobian[:3], jacobian[3:], body)
    mujoco.mj_fullM(model, data, inertia)
    arm = plant.layout.v - 1 - model.nq
    J = jacobian[:, arm]
    damped = J @ J.T + 1e-4 * np.eye(6)
    return np.asarray(np.linalg.solve(damped, J) @ inertia[np.ix_(arm, arm)])
