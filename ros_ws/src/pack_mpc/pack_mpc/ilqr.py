"""Iterative LQR: one backward pass and one batch of line-search rollouts an iteration.

Li and Todorov, "Iterative linear quadratic regulator design for nonlinear biological movement
systems", 2004; regularisation and line search after Tassa, Erez and Todorov, 2012.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from pydantic import Field, PositiveFloat

from pack_core.config import Config
from pack_core.rotations import Array
from pack_mpc.riccati import backward_pass, forward_pass


@dataclass(frozen=True)
class Linearization:
    """dx' = A dx + B du, dy = C dx + D du: `A (T,n,n)`, `B (T,n,m)`, `C (T+1,p,n)`, `D (T,p,m)`."""

    A: Array
    B: Array
    C: Array
    D: Array


@dataclass(frozen=True)
class Expansion:
    """Quadratic model of the cost, running steps and the last one.

    `lx (T+1,n)`, `lxx (T+1,n,n)`, `lu (T,m)`, `luu (T,m,m)`, `lux (T,m,n)`.
    """

    lx: Array
    lxx: Array
    lu: Array
    luu: Array
    lux: Array


class Plant(Protocol):
    """What iLQR needs of the dynamics."""

    limits: Array

    def rollout(self, x0: Array, us: Array) -> tuple[Array, Array]:
        """States and outputs of a batch of control sequences."""
        ...

    def linearize(self, xs: Array, us: Array, columns: np.ndarray, keypoints: np.ndarray) -> Linearization:
        """Derivatives along a trajectory."""
        ...


class Cost(Protocol):
    """What iLQR needs of the cost."""

    def value(self, xs: Array, ys: Array, us: Array) -> Array:
        """Costs `(B,)` of a batch of trajectories."""
        ...

    def expand(self, xs: Array, ys: Array, us: Array, lin: Linearization, columns: np.ndarray) -> Expansion:
        """Gauss-Newton expansion along one trajectory."""
        ...


class IlqrConfig(Config):
    """Parameters of the optimizer."""

    keypoint_interval: int = Field(default=10, ge=1, description="steps between finite differences")
    step_sizes: tuple[float, ...] = Field(default=(1.0, 0.3), description="line search")
    regularisation_min: PositiveFloat = 1e-6
    regularisation_max: PositiveFloat = 1e4


@dataclass(frozen=True)
class Rollout:
    """A rollout: `xs (T+1,nx)`, `ys (T+1,ny)`, `us (T,m)` and its cost."""

    xs: Array
    ys: Array
    us: Array
    cost: float


@dataclass(frozen=True)
class Iteration:
    """What one iteration gave; `step_size` 0 means that the nominal trajectory stands."""

    trajectory: Rollout
    step_size: float
    regularisation: float
    warning: str = ""


def cheapest(plant: Plant, cost: Cost, x0: Array, us: Array) -> tuple[Rollout, int]:
    """Roll out control sequences `(B, T, m)`; the cheapest, and which it is. Infinite if all diverge."""
    xs, ys = plant.rollout(x0, us)
    costs = cost.value(xs, ys, us)
    costs = np.where(np.isfinite(costs), costs, np.inf)
    best = int(np.argmin(costs))
    return Rollout(xs[best], ys[best], us[best], float(costs[best])), best


def iterate(
    plant: Plant, cost: Cost, nominal: Rollout, columns: np.ndarray, regularisation: float,
    config: IlqrConfig,
) -> Iteration:  # fmt: skip
    """Improve a nominal trajectory once; the cost never rises.

    Args:
        plant: the dynamics.
        cost: the cost.
        nominal: where to linearise.
        columns: components of the state that take part.
        regularisation: added to Quu's diagonal.
        config: parameters.
    """
    steps = len(nominal.us)
    keypoints = np.unique(np.append(np.arange(0, steps, config.keypoint_interval), steps))
    lin = plant.linearize(nominal.xs, nominal.us, columns, keypoints)
    quadratic = cost.expand(nominal.xs, nominal.ys, nominal.us, lin, columns)
    if not all(np.all(np.isfinite(a)) for a in (lin.A, lin.B, quadratic.lxx, quadratic.lx)):
        return Iteration(nominal, 0.0, regularisation, "derivatives are not finite")
    while regularisation <= config.regularisation_max:
        gains = _gains(lin, quadratic, regularisation)
        if gains is not None:
            break
        regularisation *= 10.0
    else:
        return Iteration(nominal, 0.0, config.regularisation_max, "no descent direction")
    direction = forward_pass(np.ascontiguousarray(lin.A), np.ascontiguousarray(lin.B), *gains)
    return _line_search(plant, cost, nominal, direction, regularisation, config)


def _gains(lin: Linearization, cost: Expansion, regularisation: float) -> tuple[Array, Array] | None:
    F = np.concatenate([lin.A, lin.B], axis=2)
    q = np.concatenate([cost.lx[:-1], cost.lu], axis=1)
    Q = np.block([[cost.lxx[:-1], cost.lux.swapaxes(1, 2)], [cost.lux, cost.luu]])
    vx, vxx = np.ascontiguousarray(cost.lx[-1]), np.ascontiguousarray(cost.lxx[-1])
    is_definite, k, K = backward_pass(F, q, Q, vx, vxx, regularisation)
    return (k, K) if is_definite else None


def _line_search(
    plant: Plant, cost: Cost, nominal: Rollout, direction: Array, regularisation: float, config: IlqrConfig
) -> Iteration:
    """Roll out every step size at once and keep the cheapest, if it is cheaper than the nominal."""
    sizes = np.array(config.step_sizes)
    us = np.clip(nominal.us + sizes[:, None, None] * direction, -plant.limits, plant.limits)
    trajectory, best = cheapest(plant, cost, nominal.xs[0], us)
    if not trajectory.cost < nominal.cost:
        return Iteration(nominal, 0.0, min(regularisation * 10.0, config.regularisation_max))
    relaxed = regularisation / 5.0 if sizes[best] > 0.2 else regularisation
    return Iteration(trajectory, float(sizes[best]), max(relaxed, config.regularisation_min))
