"""The cross-entropy method of judo (PyPI `judo-rai`) on the controller's own model and cost, to compare with.

As judo's controller runs it: knots are sampled around the last plan, interpolated linearly and rolled out,
and the mean of the elites is the plan. The knots are twists of the held object, as SGN has them: on joint
positions the method drifts away from where it should go. They are scaled to [-1, 1], and the deviations,
rollouts, elites and number of knots are judo's own for its Panda task; step and horizon are those of SGN.
"""

from __future__ import annotations

import importlib
from typing import Any

import numpy as np
from pydantic import Field, PositiveFloat, PositiveInt

from pack_core.config import Config
from pack_core.errors import PackError
from pack_core.extras import install_command
from pack_core.packing.cell import PackingCell
from pack_core.packing.model import HELD_POSITION, ArmRole
from pack_core.packing.scene import Scene
from pack_core.rotations import Array
from pack_mpc.cost.cost import PackingCost
from pack_mpc.optimizers.optimizer import Optimizer, Solution
from pack_mpc.optimizers.spline import Basis, ResolvedRateServo, ServoReference, predicted_setpoints
from pack_mpc.plant import PackingPlant
from pack_mpc.state_reduction import StateReductionConfig
from pack_mpc.target import PackingTarget, Stage

WORTHLESS = 1e12
"""Cost of a rollout that diverged."""


class JudoConfig(Config):
    """Parameters of the optimizer `judo`: judo's own for its task `fr3_pick`, those of `sgn` for the rest."""

    nodes: PositiveInt = Field(default=4, description="knots of the twist spline")
    rollouts: PositiveInt = Field(default=64, description="random splines in each iteration")
    elites: PositiveInt = Field(default=3, description="cheapest splines, whose mean is the plan")
    sigma_min: PositiveFloat = Field(
        default=0.01, description="least standard deviation of the samples, as a share of the largest twist"
    )
    sigma_max: PositiveFloat = Field(default=0.3, description="largest standard deviation, likewise")
    noise_ramp: PositiveFloat = Field(default=4.0, description="growth of the deviation along the spline")
    timestep: PositiveFloat = Field(default=0.02, description="time step of the model [s]")
    horizon: PositiveInt = Field(default=30, description="length of the horizon, in steps")
    speed_linear: PositiveFloat = Field(default=0.4, description="largest linear twist [m/s]")
    speed_angular: PositiveFloat = Field(default=1.5, description="largest angular twist [rad/s]")
    leash: PositiveFloat = Field(
        default=0.04, description="lead limit: how far the reference may be ahead of the arm [m]"
    )
    reduction: StateReductionConfig = StateReductionConfig()


class JudoOptimizer(Optimizer):
    """judo's `CrossEntropyMethod` behind the interface of our optimizers.

    Raises:
        PackError: judo is not installed.
    """

    parameters = JudoConfig

    def __init__(self, scene: Scene, cell: PackingCell, config: JudoConfig, threads: int) -> None:
        self.plant = PackingPlant(scene, cell, timestep=config.timestep, threads=threads, arm=ArmRole.SERVO)
        self._config, self._drive = config, cell.robot
        self._method = _make_method(config)
        times = np.asarray(config.timestep * np.arange(config.horizon), dtype=float)
        self._basis = Basis(times, np.linspace(0.0, config.timestep * config.horizon, config.nodes))
        self._largest = np.array([config.speed_linear] * 3 + [config.speed_angular] * 3)
        self._knots = np.zeros((config.nodes, 6))
        self._reference: ServoReference | None = None
        np.random.seed(0)  # noqa: NPY002 - judo has no generator of its own

    @classmethod
    def require(cls) -> None:
        require_judo()

    def go_on_from(self, last: Optimizer) -> None:
        assert isinstance(last, JudoOptimizer)
        self._knots, self._reference = last._knots, last._reference

    def improve(self, x0: Array, cost: PackingCost, stage: Stage, target: PackingTarget) -> Solution:
        """One iteration from the state `x0`: the mean of the cheapest splines is the plan."""
        last, now, q_arm = self._reference, float(x0[0]), x0[self.plant.layout.q]
        start, q_ref = (now, q_arm) if last is None else (last.time, last.at(now, q_arm))
        servo = ResolvedRateServo(self.plant, q_arm, q_ref, self._config.leash)
        nominal = self._basis.shifted(self._knots, now - start)
        self._method.pre_optimization(start + self._basis.knots, now + self._basis.knots)
        samples = np.clip(self._method.sample_control_knots(nominal), -1.0, 1.0)
        costs = self._roll_out(servo, x0, cost, samples)[0]
        self._knots = self._method.update_nominal_knots(samples, -costs)
        # The mean of the elites was not among the samples: what it does is not known yet.
        costs, xs, ys, q, v = self._roll_out(servo, x0, cost, self._knots[None])
        self._reference = ServoReference(now, self._basis.times, q[0])
        setpoints = predicted_setpoints(self.plant, self._drive, self._basis.times, xs[0, :-1], q[0], v[0])
        path = ys[0][:, self.plant.sensor(HELD_POSITION)]
        return Solution(setpoints, path, float(costs[0]), 1.0, 0.0)

    def _roll_out(
        self, servo: ResolvedRateServo, x0: Array, cost: PackingCost, knots: Array
    ) -> tuple[Array, Array, Array, Array, Array]:
        """Costs `(B,)`, states, outputs, and reference positions and velocities of knots `(B, K, 6)`."""
        q, v = self._references(servo, knots)
        xs, ys = self.plant.rollout(x0, np.concatenate([q, v], axis=2))
        costs = (cost.weighted(xs, ys) ** 2).sum(axis=1)
        return np.where(np.isfinite(costs), costs, WORTHLESS), xs, ys, q, v

    def _references(self, servo: ResolvedRateServo, knots: Array) -> tuple[Array, Array]:
        """Joint positions and velocities `(B, T, 7)` of scaled twist knots `(B, K, 6)`."""
        return servo.references(self._basis.matrix() @ (knots * self._largest), self._config.timestep)


def require_judo() -> Any:
    """The module of judo's cross-entropy method.

    Raises:
        PackError: judo is not installed.
    """
    try:
        return importlib.import_module("judo.optimizers.cem")
    except ImportError as error:
        raise PackError(
            "the optimizer judo needs the package judo-rai, which is not installed: "
            f"{install_command('judo', '--no-deps')}, or choose another optimizer"
        ) from error


def _make_method(config: JudoConfig) -> Any:
    cem = require_judo()
    parameters = cem.CrossEntropyMethodConfig(
        num_rollouts=config.rollouts, num_nodes=config.nodes, num_elites=config.elites,
        sigma_min=config.sigma_min, sigma_max=config.sigma_max,
        use_noise_ramp=True, noise_ramp=config.noise_ramp,
    )  # fmt: skip
    return cem.CrossEntropyMethod(parameters, 6)
