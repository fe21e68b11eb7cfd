"""Spline Gauss-Newton by rollouts (SGN): a few twist knots, large finite differences, explorers.

One batch of rollouts perturbs the parameters by a step that is large enough to see past a contact, on a busy
machine some of them in turn, and the differences by the others are kept. The Gauss-Newton steps that follow
are rolled out in a second batch, at several dampings, and the cheapest rollout of both is the plan. Every
rollout is independent of the others.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from pydantic import Field, NonNegativeFloat, NonNegativeInt, PositiveFloat, PositiveInt

from pack_core.config import Config
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

SPARING = 3
"""So many times as many iterations perturb every parameter once while the machine is busy. An iteration
then takes half of the time, and the largest force of a goal is a third larger in the mean."""


class SgnConfig(Config):
    """Parameters of the optimizer `sgn`; a twist is linear [m/s], then angular [rad/s]."""

    timestep: PositiveFloat = Field(default=0.02, description="time step of the model [s]")
    horizon: PositiveInt = Field(default=30, description="length of the horizon, in steps")
    knots: int = Field(default=3, ge=2, description="knots of the twist spline")
    step_linear: PositiveFloat = Field(default=0.05, description="step of the finite differences [m/s]")
    step_angular: PositiveFloat = Field(default=0.25, description="step of the finite differences [rad/s]")
    explorers: NonNegativeInt = Field(
        default=0, description="random splines in each iteration, where perturbations alone get stuck"
    )
    spread_linear: PositiveFloat = Field(default=0.12, description="standard deviation of explorers [m/s]")
    spread_angular: PositiveFloat = Field(default=0.5, description="standard deviation of explorers [rad/s]")
    dampings: tuple[PositiveFloat, ...] = Field(
        default=(0.01, 0.1, 1.0),
        min_length=1,
        description="dampings of the Gauss-Newton steps, one rollout each",
    )
    speed_linear: PositiveFloat = Field(default=0.4, description="largest linear twist [m/s]")
    speed_down: PositiveFloat = Field(default=0.4, description="largest downward twist [m/s]")
    speed_landing: PositiveFloat = Field(
        default=0.07, description="largest downward twist where the object may land on another [m/s]"
    )
    speed_angular: PositiveFloat = Field(default=1.5, description="largest angular twist [rad/s]")
    effort: NonNegativeFloat = Field(default=0.02, description="weight of the squared knots in the cost")
    turns: PositiveInt = Field(
        default=1,
        description="iterations within which every parameter is perturbed once, and a halt and the straight "
        "way are tried; what a parameter changes counts until it is perturbed again",
    )
    leash: PositiveFloat = Field(
        default=0.04, description="lead limit: how far the reference may be ahead of the arm [m]"
    )
    reduction: StateReductionConfig = StateReductionConfig()


@dataclass(frozen=True)
class RolloutBatch:
    """B rollouts at once.

    Attributes:
        residuals: weighted residuals `(B, M)`.
        costs: `(B,)`; infinite for a rollout that diverged.
        xs: states `(B, T+1, nx)`.
        ys: outputs `(B, T+1, ny)`.
        q: desired joint positions `(B, T, 7)` [rad].
        v: desired joint velocities `(B, T, 7)` [rad/s].
    """

    residuals: Array
    costs: Array
    xs: Array
    ys: Array
    q: Array
    v: Array


class SgnOptimizer(Optimizer):
    """Improves a twist spline: knots theta `(K, 6)`; the driver's servos are part of its model."""

    parameters = SgnConfig

    def __init__(self, scene: Scene, cell: PackingCell, config: SgnConfig, threads: int) -> None:
        self._config, self._drive = config, cell.robot
        self.plant = PackingPlant(scene, cell, timestep=config.timestep, threads=threads, arm=ArmRole.SERVO)
        times = np.asarray(config.timestep * np.arange(config.horizon), dtype=float)
        end = config.horizon * config.timestep
        self._basis = Basis(times, np.linspace(0.0, end, config.knots))
        self._rng = np.random.default_rng(0)
        self._steps = np.repeat([[config.step_linear] * 3 + [config.step_angular] * 3], config.knots, axis=0)
        self._spread = np.array([config.spread_linear] * 3 + [config.spread_angular] * 3)
        self._upper = np.array([config.speed_linear] * 3 + [config.speed_angular] * 3)
        self._lower = -self._upper
        self._theta = np.zeros((config.knots, 6))
        self._turn = 0
        self._J: Array | None = None  # (M, 6 K), M weighted residuals by the parameters
        self._rows_of: tuple[Stage, tuple[str, ...], list[str]] | None = None
        self._reference: ServoReference | None = None

    def improve(self, x0: Array, cost: PackingCost, stage: Stage, target: PackingTarget) -> Solution:
        """One iteration from the state `x0`: the cheapest rollout of both batches is the plan."""
        self._lower[2] = -self._fastest_down(target)
        # The weights are the stage's, and the rows those of the collision list and of the objects in the
        # state: no differences outlast them.
        if self._rows_of != (rows_of := (stage, target.collisions, self.plant.scene.names)):
            self._J, self._rows_of = None, rows_of
        nominal, servo = self._clip(self._shifted(x0)), self._servo(x0)
        self._turn += 1
        thetas, signs = self._first_batch(nominal, x0, target)
        first = self._roll_out(servo, x0, cost, thetas)
        steps = self._gauss_newton(first, thetas, signs)
        second = self._roll_out(servo, x0, cost, steps)
        costs = np.concatenate([first.costs, second.costs])
        best = int(np.argmin(costs))
        self._theta = np.concatenate([thetas, steps])[best]
        batch, i = (first, best) if best < len(first.costs) else (second, best - len(first.costs))
        return self._solution(batch, i, step_size=float(best > 0))

    def go_on_from(self, last: Optimizer) -> None:
        """Take over the plan, which is the arm's alone; the differences are of the objects of that model."""
        assert isinstance(last, SgnOptimizer)
        self._theta, self._reference, self._turn, self._rng = (
            last._theta, last._reference, last._turn, last._rng,
        )  # fmt: skip

    def _fastest_down(self, target: PackingTarget) -> float:
        """Largest downward speed [m/s]: slow where it may land on something."""
        config = self._config
        return min(config.speed_down, config.speed_landing) if target.may_land else config.speed_down

    def _shifted(self, x0: Array) -> Array:
        """The last plan's knots as seen from the time of `x0`."""
        if self._reference is None:
            return np.zeros_like(self._theta)
        return self._basis.shifted(self._theta, float(x0[0]) - self._reference.time)

    def _servo(self, x0: Array) -> ResolvedRateServo:
        """The servos at `x0`; they go on from where the last plan's reference stands by then."""
        last, q_arm = self._reference, x0[self.plant.layout.q]
        q_ref = q_arm if last is None else last.at(float(x0[0]), q_arm)
        return ResolvedRateServo(self.plant, q_arm, q_ref, self._config.leash)

    def _due(self, numbers: np.ndarray) -> np.ndarray:
        """Which of what is numbered takes its turn in this iteration: all at first, and fewer if sparing."""
        turns = self._config.turns * (SPARING if self.is_sparing else 1)
        return np.asarray((numbers % turns == self._turn % turns) | (self._J is None))

    def _first_batch(self, nominal: Array, x0: Array, target: PackingTarget) -> tuple[Array, Array]:
        """The splines of the first batch, all within bounds, and the signs of the perturbations.

        Returns:
            Splines `(B, K, 6)`: the nominal one, one perturbation for each of the n parameters that are due,
            a halt or a straight way to the target or both, random explorers; and signs `(6 K,)`, 0 where
            nothing is perturbed.
        """
        # Numbered by diagonals: in one iteration the knots are perturbed along different axes.
        due = self._due(np.indices(nominal.shape).sum(axis=0))
        signs = (self._signs(nominal) * due).ravel()
        deltas = np.diag(signs * self._steps.ravel())[signs != 0.0].reshape(-1, *nominal.shape)
        explorers = nominal + self._rng.normal(size=(self._config.explorers, *nominal.shape)) * self._spread
        ways = np.stack([np.zeros_like(nominal), self._straight(x0, target)])[self._due(np.arange(2))]
        thetas = np.concatenate(
            [nominal[None], nominal + deltas, self._clip(np.concatenate([ways, explorers]))]
        )
        return thetas, signs

    def _signs(self, nominal: Array) -> Array:
        """Random signs of the perturbations `(K, 6)`, towards the inside where a bound is near."""
        signs = self._rng.choice([-1.0, 1.0], nominal.shape)
        ahead = nominal + signs * self._steps
        return np.where((ahead > self._upper) | (ahead < self._lower), -signs, signs)

    def _straight(self, x0: Array, target: PackingTarget) -> Array:
        """The spline that heads straight for the target and stops there."""
        twist = np.zeros(6)
        # The speed that covers the way in half the horizon; bounds cut it, and the last knot is at rest.
        twist[:3] = (target.p_WN - self.plant.held_position(x0)) / (0.5 * self._basis.knots[-1])
        return np.concatenate([np.tile(twist, (len(self._theta) - 1, 1)), np.zeros((1, 6))])

    def _roll_out(
        self, servo: ResolvedRateServo, x0: Array, cost: PackingCost, thetas: Array
    ) -> RolloutBatch:
        q, v = servo.references(self._basis.matrix() @ thetas, self._config.timestep)
        xs, ys = self.plant.rollout(x0, np.concatenate([q, v], axis=2))
        residuals = cost.weighted(xs, ys)
        costs = (residuals**2).sum(axis=1) + self._config.effort * (thetas**2).sum(axis=(1, 2))
        return RolloutBatch(residuals, np.where(np.isfinite(costs), costs, np.inf), xs, ys, q, v)

    def _gauss_newton(self, batch: RolloutBatch, thetas: Array, signs: Array) -> Array:
        """Gauss-Newton steps from the nominal, one for each damping `(D, K, 6)`.

        With weighted residuals r, J = dr/dtheta and effort e, the cost r'r + e theta'theta has half the
        gradient g = J'r + e theta and half the Hessian H = J'J + e I. The steps are Levenberg-Marquardt's,
        -(H + d diag(H))^-1 g, short ones for a large damping d. What J has of parameters that were not
        perturbed is that of the iterations before, at the same time from the beginning of the horizon.
        """
        varied, nominal = np.flatnonzero(signs), thetas[0]
        n = len(varied)
        # Rollout 0 is the nominal one, 1 to n are its perturbations.
        changes = (batch.residuals[1 : n + 1] - batch.residuals[0]).T
        J = np.empty((len(changes), nominal.size)) if self._J is None else self._J
        J[:, varied] = changes / (signs * self._steps.ravel())[varied]
        if not np.all(np.isfinite(J)):
            self._J = None
            return np.asarray(nominal[None])
        self._J = J
        gradient = J.T @ batch.residuals[0] + self._config.effort * nominal.ravel()
        hessian = J.T @ J + self._config.effort * np.eye(nominal.size)
        steps = [
            -np.linalg.solve(hessian + d * np.diag(np.diag(hessian)), gradient) for d in self._config.dampings
        ]
        return self._clip(nominal + np.reshape(steps, (-1, *nominal.shape)))

    def _solution(self, batch: RolloutBatch, i: int, step_size: float) -> Solution:
        """Rollout i of a batch as the plan, and its reference as the one to go on from."""
        # The last reference holds to the end of the horizon, where no step begins any more.
        offsets = np.append(self._basis.times, self._basis.knots[-1])
        q, v = (np.concatenate([part[i], part[i, -1:]]) for part in (batch.q, batch.v))
        xs = batch.xs[i]
        self._reference = ServoReference(float(xs[0, 0]), offsets, q)
        setpoints = predicted_setpoints(self.plant, self._drive, offsets, xs, q, v)
        path = batch.ys[i][:, self.plant.sensor(HELD_POSITION)]
        return Solution(setpoints, path, float(batch.costs[i]), step_size, 0.0)

    def _clip(self, thetas: Array) -> Array:
        return np.asarray(np.clip(thetas, self._lower, self._upper))
