"""The cross-entropy method of judo (PyPI `judo-rai`) on the controller's own model and cost, to compare with.

As judo's controller runs it: knots of joint references are sampled around the last plan, interpolated
linearly, rolled out, and the mean of the elites is the plan. The parameters are judo's own for its Panda
task; only the horizon is that of our optimizers, for which the weights are made.
"""

from __future__ import annotations

import importlib
from typing import Any

import numpy as np
from pydantic import Field, PositiveFloat, PositiveInt
from scipy.interpolate import interp1d

from pack_core.cells.packing import PackingCell
from pack_core.config import Config
from pack_core.errors import PackError
from pack_core.robots.panda import LOWER, UPPER, VELOCITY_LIMITS
from pack_core.rotations import Array
from pack_core.scene.model import HELD_POSITION, Arm
from pack_core.scene.scene import Scene
from pack_core.scene.state import Setpoints
from pack_mpc.cost import PackingCost
from pack_mpc.plant import PackingPlant
from pack_mpc.residuals import Target
from pack_mpc.solution import Solution
from pack_mpc.weights import Stage

WORTHLESS = 1e12
"""Cost of a rollout that diverged."""


class JudoConfig(Config):
    """judo's overrides for `fr3_pick`, but for the horizon and the model's step."""

    timestep: PositiveFloat = Field(default=0.012, description="of the model [s]")
    horizon: PositiveInt = Field(default=50, description="steps")
    nodes: PositiveInt = Field(default=4, description="knots of the spline")
    rollouts: PositiveInt = Field(default=64, description="samples an iteration")
    elites: PositiveInt = Field(default=3, description="whose mean is the plan")
    sigma_min: PositiveFloat = Field(default=0.01, description="deviation of the samples [rad]")
    sigma_max: PositiveFloat = Field(default=0.3, description="deviation of the samples [rad]")
    noise_ramp: PositiveFloat = Field(default=4.0, description="growth of the deviation along the spline")


class JudoOptimizer:
    """judo's `CrossEntropyMethod` behind the interface of our optimizers.

    Args:
        scene: shapes, sizes and masses of the objects that are taken into account.
        cell: the cell's physical facts.
        config: parameters.
        threads: of the rollouts.
        seed: of numpy's global generator, which judo draws from.

    Raises:
        PackError: judo is not installed.
    """

    def __init__(self, scene: Scene, cell: PackingCell, config: JudoConfig, threads: int, seed: int) -> None:
        self.plant = PackingPlant(scene, cell, timestep=config.timestep, threads=threads, arm=Arm.SERVO)
        self._config = config
        self._method = _make_method(config)
        self._times = np.asarray(config.timestep * np.arange(config.horizon), dtype=float)
        self._node_times = np.linspace(0.0, config.timestep * config.horizon, config.nodes)
        self._start, self._knots = 0.0, np.empty((0, 7))
        np.random.seed(seed)  # noqa: NPY002 - judo has no generator of its own

    def change_cost(self) -> None:
        """Nothing is kept that belongs to one cost."""

    def improve(self, x0: Array, cost: PackingCost, stage: Stage, target: Target) -> Solution:
        """One iteration from state `x0`."""
        nominal = self._nominal(x0)
        self._method.pre_optimization(self._start + self._node_times, x0[0] + self._node_times)
        samples = np.clip(self._method.sample_control_knots(nominal), LOWER, UPPER)
        q, v = self._references(samples)
        xs, ys = self.plant.rollout(x0, np.concatenate([q, v], axis=2))
        costs = (cost.weighted(xs, ys) ** 2).sum(axis=1)
        costs = np.where(np.isfinite(costs), costs, WORTHLESS)
        self._knots = self._method.update_nominal_knots(samples, -costs)
        self._start, best = float(x0[0]), int(np.argmin(costs))
        q, v = self._references(self._knots[None])
        setpoints = Setpoints(self._start, self._times, q[0], v[0], np.zeros_like(q[0]))
        path = ys[best][:, self.plant.sensor(HELD_POSITION)]
        return Solution(setpoints, path, float(costs[best]), float(best > 0), 0.0)

    def _nominal(self, x0: Array) -> Array:
        """The last plan's knots, moved on to the time of `x0`; at first the arm stays `(K, 7)`."""
        if not self._knots.size:
            self._start = float(x0[0])
            return np.tile(x0[self.plant.layout.q], (self._config.nodes, 1))
        return _spline(self._start + self._node_times, self._knots, x0[0] + self._node_times)

    def _references(self, knots: Array) -> tuple[Array, Array]:
        """Joint positions and velocities `(B, T, 7)` of knots `(B, K, 7)`."""
        q = _spline(self._node_times, knots, self._times)
        ahead = _spline(self._node_times, knots, self._times + self._config.timestep)
        return q, np.clip((ahead - q) / self._config.timestep, -VELOCITY_LIMITS, VELOCITY_LIMITS)


def _spline(times: Array, knots: Array, at: Array) -> Array:
    """Knots `(..., K, 7)` interpolated linearly, and held beyond the last."""
    ends = (knots[..., 0, :], knots[..., -1, :])
    return np.asarray(interp1d(times, knots, axis=-2, bounds_error=False, fill_value=ends)(at))


def require_judo() -> Any:
    """The module of judo's cross-entropy method.

    Raises:
        PackError: judo is not installed.
    """
    try:
        return importlib.import_module("judo.optimizers.cem")
    except ImportError as error:
        raise PackError(
            "--optimizer judo needs judo, which is not installed: "
            "uv pip install --no-deps -r requirements/judo.txt (docs/benchmark.md)"
        ) from error


def _make_method(config: JudoConfig) -> Any:
    cem = require_judo()
    parameters = cem.CrossEntropyMethodConfig(
        num_rollouts=config.rollouts, num_nodes=config.nodes, num_elites=config.elites,
        sigma_min=config.sigma_min, sigma_max=config.sigma_max,
        use_noise_ramp=True, noise_ramp=config.noise_ramp,
    )  # fmt: skip
    return cem.CrossEntropyMethod(parameters, 7)
