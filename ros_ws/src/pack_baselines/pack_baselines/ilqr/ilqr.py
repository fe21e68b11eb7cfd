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
from pack_mpc.cost.cost import Expansion
from pack_mpc.plant import Linearization

REGULARISATION_UP, REGULARISATION_DOWN = 10.0, 5.0
"""Factors by which the regularisation grows after a failure and shrinks after a step that can be trusted."""
TRUSTED_STEP = 0.2
"""Step size above which the quadratic model counts as right."""


class Plant(Protocol):
    """What iLQR needs of the dynamics.

    Attributes:
        limits: largest absolute controls `(m,)`.
    """

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
    """Parameters of one iteration."""

    keypoint_interval: int = Field(default=10, ge=1, description="steps between finite differences")
    step_sizes: tuple[PositiveFloat, ...] = Field(default=(1.0, 0.3), min_length=1, description="line search")
    regularisation_min: PositiveFloat = Field(default=1e-6, description="least regularisation of Quu")
    regularisation_max: PositiveFloat = Field(
        default=1e4, description="regularisation beyond which an iteration gives up"
    )


@dataclass(frozen=True)
class Rollout:
    """One trajectory: states `xs (T+1,nx)`, outputs `ys (T+1,ny)`, controls `us (T,m)`, and its cost."""

    xs: Array
    ys: Array
    us: Array
    cost: float


@dataclass(frozen=True)
class Iteration:
    """What one iteration gave.

    Attributes:
        trajectory: the new nominal trajectory.
        step_size: step size of the line search; 0 means that the nominal trajectory stands.
        regularisation: regularisation for the next iteration.
        warning: what went wrong; empty when all is well.
    """

    trajectory: Rollout
    step_size: float
    regularisation: float
    warning: str = ""


def cheapest(plant: Plant, cost: Cost, x0: Array, us: Array) -> tuple[Rollout, int]:
    """Roll out control sequences `(B, T, m)`.

    Returns:
        The cheapest rollout and its index; its cost is infinite if all of them diverge.
    """
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
        nominal: the trajectory along which dynamics and cost are expanded.
        columns: components of the state that take part; the others count as constant.
        regularisation: added to the diagonal of Quu, the Hessian by the controls.
        config: parameters.
    """
    steps = len(nominal.us)
    # Key-points: finite differences are dear, so they are taken at some steps and interpolated (paper, IV-B).
    keypoints = np.unique(np.append(np.arange(0, steps, config.keypoint_interval), steps))
    lin = plant.linearize(nominal.xs, nominal.us, columns, keypoints)
    quadratic = cost.expand(nominal.xs, nominal.ys, nominal.us, lin, columns)
    if not all(np.all(np.isfinite(a)) for a in (lin.A, lin.B, quadratic.lxx, quadratic.lx)):
        return Iteration(nominal, 0.0, regularisation, "derivatives are not finite")
    while regularisation <= config.regularisation_max:
        direction = _direction(lin, quadratic, regularisation)
        if direction is not None:
            break
        regularisation *= REGULARISATION_UP
    else:
        return Iteration(nominal, 0.0, config.regularisation_max, "no descent direction")
    return _line_search(plant, cost, nominal, direction, regularisation, config)


def _direction(lin: Linearization, cost: Expansion, regularisation: float) -> Array | None:
    """Change of the controls `(T, m)` for a full step; None if Quu is not positive definite at some step.

    The recursion works on z = (x, u): F = [A B], and Q is the Hessian of the step's cost by z.
    """
    # a second and 50 MB, which a process saves that plans with another optimizer
    from pack_baselines.ilqr.riccati import backward_pass, forward_pass

    F = np.concatenate([lin.A, lin.B], axis=2)
    q = np.concatenate([cost.lx[:-1], cost.lu], axis=1)
    Q = np.block([[cost.lxx[:-1], cost.lux.swapaxes(1, 2)], [cost.lux, cost.luu]])
    vx, vxx = np.ascontiguousarray(cost.lx[-1]), np.ascontiguousarray(cost.lxx[-1])
    is_definite, k, K = backward_pass(F, q, Q, vx, vxx, regularisation)
    return (
        forward_pass(np.ascontiguousarray(lin.A), np.ascontiguousarray(lin.B), k, K) if is_definite else None
    )


def _line_search(
    plant: Plant, cost: Cost, nominal: Rollout, direction: Array, regularisation: float, config: IlqrConfig
) -> Iteration:
    """Roll out every step size at once and keep the cheapest, if it is cheaper than the nominal."""
    sizes = np.array(config.step_sizes)
    us = np.clip(nominal.us + sizes[:, None, None] * direction, -plant.limits, plant.limits)
    trajectory, best = cheapest(plant, cost, nominal.xs[0], us)
    if not trajectory.cost < nominal.cost:
        raised = regularisation * REGULARISATION_UP
        return Iteration(nominal, 0.0, min(raised, config.regularisation_max))
    # A step of some length says that the quadratic model holds: trust it further next time.
    is_trusted = sizes[best] > TRUSTED_STEP
    relaxed = regularisation / REGULARISATION_DOWN if is_trusted else regularisation
    return Iteration(trajectory, float(sizes[best]), max(relaxed, config.regularisation_min))
