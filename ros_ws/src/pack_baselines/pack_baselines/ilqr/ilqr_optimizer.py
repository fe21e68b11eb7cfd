"""iLQR on joint torques, as in the paper: finite differences over the arm and the objects that move."""

from __future__ import annotations

from importlib import import_module

import numpy as np
from pydantic import Field, NonNegativeFloat, PositiveFloat, PositiveInt

from pack_baselines.ilqr.explorers import ExplorerConfig, explore
from pack_baselines.ilqr.ilqr import IlqrConfig, Iteration, Rollout, cheapest, iterate
from pack_core.config import Config
from pack_core.joints import Setpoints
from pack_core.packing.cell import PackingCell
from pack_core.packing.model import HELD_POSITION
from pack_core.packing.scene import Scene
from pack_core.rotations import Array
from pack_mpc.cost.cost import PackingCost
from pack_mpc.optimizers.optimizer import Optimizer, Solution
from pack_mpc.plant import PackingPlant
from pack_mpc.state_reduction import StateReductionConfig
from pack_mpc.target import PackingTarget, Stage

DIVERGED = 20.0
"""Joint speed beyond which a rollout is worthless [rad/s]: many times what the arm's joints may do."""
REGULARISATION = 1e-4
"""Regularisation of Quu at the start, and again whenever the cost changes."""


class IlqrOptimizerConfig(Config):
    """Parameters of the optimizer `ilqr`."""

    timestep: PositiveFloat = Field(default=0.006, description="time step of the model [s]")
    horizon: PositiveInt = Field(default=100, description="length of the horizon, in steps")
    touched: NonNegativeFloat = Field(
        default=0.0005, description="an object that moves further over the horizon is in the state [m]"
    )
    full_state: bool = Field(
        default=False,
        description="the state is the paper's: every object, touched or not, with its orientation",
    )
    # Its few rollouts tell too little of what it may reach: without the other objects it pushes harder.
    reduction: StateReductionConfig = StateReductionConfig(margin=np.inf)
    iteration: IlqrConfig = IlqrConfig()
    explorers: ExplorerConfig = ExplorerConfig()


class IlqrOptimizer(Optimizer):
    """Improves a torque sequence; its nominal trajectory is the last plan, shifted to now."""

    parameters = IlqrOptimizerConfig

    def __init__(self, scene: Scene, cell: PackingCell, config: IlqrOptimizerConfig, threads: int) -> None:
        self._config = config
        self.plant = PackingPlant(scene, cell, timestep=config.timestep, threads=threads)
        self._rng = np.random.default_rng(0)
        self._regularisation = REGULARISATION
        self._last: Rollout | None = None

    @classmethod
    def require(cls) -> None:
        """Have the recursions compiled, or loaded, before the first iteration needs them."""
        import_module("pack_baselines.ilqr.riccati")

    def change_cost(self) -> None:
        """Start the regularisation anew; the last plan stays, as the driver is following it."""
        self._regularisation = REGULARISATION

    def improve(self, x0: Array, cost: PackingCost, stage: Stage, target: PackingTarget) -> Solution:
        """One iteration from the state `x0`, along the last plan or a cheaper explorer."""
        nominal, warning = self._nominal(x0, cost, stage, target)
        columns = self._columns(nominal)
        result = iterate(self.plant, cost, nominal, columns, self._regularisation, self._config.iteration)
        self._last, self._regularisation = result.trajectory, result.regularisation
        return self._solution(result, warning)

    def _columns(self, nominal: Rollout) -> np.ndarray:
        """Components of the state that take part in the backward pass."""
        if self._config.full_state:
            return self.plant.columns(self.plant.scene.names, turning=True)
        return self.plant.columns(self.touched(nominal))

    def touched(self, nominal: Rollout) -> list[str]:
        """Names of the objects that move along the nominal trajectory; only these are differentiated."""
        moved = []
        for name, p in self.plant.layout.object_p.items():
            path = nominal.xs[:, p]
            if np.linalg.norm(path - path[0], axis=1).max() > self._config.touched:
                moved.append(name)
        return moved

    def _nominal(
        self, x0: Array, cost: PackingCost, stage: Stage, target: PackingTarget
    ) -> tuple[Rollout, str]:
        """The last plan, shifted to now, or a cheaper explorer, and a warning if neither can be used.

        In that case the arm rests under gravity compensation, at zero torque.
        """
        candidates = self._shifted(x0)[None]
        if stage is Stage.INSERT:
            explorers = explore(
                self.plant, x0, candidates[0], -target.over, self._config.explorers, self._rng
            )
            candidates = np.concatenate([candidates, explorers])
        nominal, _ = cheapest(self.plant, cost, x0, candidates)
        if _is_sane(nominal, self.plant):
            return nominal, ""
        nominal, _ = cheapest(self.plant, cost, x0, np.zeros_like(candidates[:1]))
        return nominal, "the last plan diverged from here; started afresh"

    def _shifted(self, x0: Array) -> Array:
        """The last plan's torques `(T, 7)` from the time of `x0` on, zero beyond its end."""
        steps = self._config.horizon
        us = np.zeros((steps, 7))
        if self._last is not None:
            shift = round(float(x0[0] - self._last.xs[0, 0]) / self._config.timestep)
            if 0 <= shift < steps:
                us[: steps - shift] = self._last.us[shift:]
        return us

    def _solution(self, result: Iteration, warning: str) -> Solution:
        xs, us, layout = result.trajectory.xs[:-1], result.trajectory.us, self.plant.layout
        limits = self.plant.arm.limits
        setpoints = Setpoints(
            float(xs[0, 0]),
            np.asarray(self._config.timestep * np.arange(len(us)), dtype=float),
            np.clip(xs[:, layout.q], limits.lower, limits.upper),
            np.clip(xs[:, layout.v], -limits.velocity, limits.velocity),
            np.clip(us, -limits.effort, limits.effort),
        )
        path = result.trajectory.ys[:, self.plant.sensor(HELD_POSITION)]
        return Solution(
            setpoints,
            path,
            result.trajectory.cost,
            result.step_size,
            result.regularisation,
            result.warning or warning,
        )


def _is_sane(trajectory: Rollout, plant: PackingPlant) -> bool:
    speeds = trajectory.xs[:, plant.layout.v]
    return bool(np.isfinite(trajectory.cost) and np.all(np.abs(speeds) < DIVERGED))
