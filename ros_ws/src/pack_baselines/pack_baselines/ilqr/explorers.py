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
from pack_core.kinematics.damping import damped_square
from pack_core.rotations import Array
from pack_mpc.plant import STATE, PackingPlant

DURATIONS = (0.4, 1.0)
"""Shortest and longest displacement, as shares of the horizon."""


class ExplorerConfig(Config):
    """How far explorers go; displacements are drawn from normal distributions."""

    count: NonNegativeInt = Field(default=5, description="explorers in each iteration of INSERT")
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

    Args:
        plant: the model with torques.
        x0: full state `(nx,)`.
        us: torques of the plan `(T, 7)` [N m].
        away: horizontal unit vector `(2,)` from the obstacles; zero if there is no clear side.
        config: how far explorers go.
        rng: generator of the random displacements.
    """
    deviation = np.array([config.sideways] * 2 + [config.up] + [config.tilt] * 2 + [0.0])
    d = rng.normal(size=(config.count, 6)) * deviation
    d[::2] = _lean(d[::2], away, float(plant.scene.new_object.half_extents[2]))
    steps = len(us)
    durations = rng.uniform(*DURATIONS, config.count) * steps
    phase = np.arange(steps) / durations[:, None]
    profile = np.where(phase < 1.0, np.sin(2 * np.pi * phase), 0.0)
    # The acceleration a sin(2 pi t / D) moves by a D^2 / (2 pi) within its period D.
    peak = 2 * np.pi * d / (durations[:, None] * plant.timestep) ** 2
    acceleration = profile[..., None] * peak[:, None]
    torques = us + acceleration @ _torque_per_acceleration(plant, x0)
    return np.asarray(np.clip(torques, -plant.limits, plant.limits))


def _lean(d: Array, away: Array, half_height: float) -> Array:
    """Turn displacements `(n, 6)` into tilts about the object's lower edge, its top over the obstacles."""
    leaned, tilt = d.copy(), np.abs(d[:, 3:4])
    # For the lower edge to stay, the middle moves by half the height times the tilt, back over the obstacles.
    leaned[:, :2] = 0.5 * d[:, :2] - half_height * tilt * away
    # This axis of rotation, horizontal and normal to `away`, takes the top over the obstacles.
    leaned[:, 3:5] = tilt * np.array([away[1], -away[0]])
    return leaned


def _torque_per_acceleration(plant: PackingPlant, x0: Array) -> Array:
    """Joint torques for unit accelerations of the held object, linear then angular: `(6, 7)`."""
    model, data = plant.model, mujoco.MjData(plant.model)
    mujoco.mj_setState(model, data, x0, STATE)
    mujoco.mj_forward(model, data)
    inertia = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, inertia)
    # layout.v counts in the state [time, qpos, qvel]: less 1 and nq, it counts degrees of freedom.
    arm, J = plant.layout.v - 1 - model.nq, plant.held_jacobian(x0[plant.layout.q])
    # tau' = a' (J J')^-1 J M: the joint accelerations J^+ a times the inertia; damped near singular postures.
    return np.asarray(np.linalg.solve(damped_square(J), J) @ inertia[np.ix_(arm, arm)])
