"""The model predictive controller: one iteration from a measured state to setpoints."""

from __future__ import annotations

import time as wall_clock
from dataclasses import dataclass

import numpy as np
from pack_core.cells.packing import PackingCell
from pack_core.config import Config
from pack_core.robots.panda import LOWER, TORQUE_LIMITS, UPPER, VELOCITY_LIMITS
from pack_core.rotations import Array
from pack_core.scene.model import HELD_POSITION
from pack_core.scene.scene import Scene
from pack_core.scene.state import JointSample, SceneState, Setpoints
from pydantic import Field, NonNegativeFloat, PositiveFloat, PositiveInt

from pack_mpc.cost import PackingCost
from pack_mpc.explorers import ExplorerConfig, explore
from pack_mpc.ilqr import IlqrConfig, Trajectory, evaluate, iterate
from pack_mpc.plant import PackingPlant
from pack_mpc.predictor import predict
from pack_mpc.residuals import Residuals, Target
from pack_mpc.weights import Stage, WeightSet

DIVERGED = 20.0
"""Joint speed beyond which a rollout is worthless [rad/s]."""
REGULARISATION = 1e-4


class ControllerConfig(Config):
    """Parameters of the controller."""

    timestep: PositiveFloat = Field(default=0.006, description="of the model [s]")
    horizon: PositiveInt = Field(default=100, description="steps")
    threads: int = Field(default=2, ge=1, description="of the rollouts")
    published: PositiveInt = Field(default=40, description="steps of the plan that are sent to the driver")
    touched: NonNegativeFloat = Field(
        default=0.0005, description="an object that moves further over the horizon is in the state [m]"
    )
    ilqr: IlqrConfig = IlqrConfig()
    explorers: ExplorerConfig = ExplorerConfig()


@dataclass(frozen=True)
class Plan:
    """What one iteration decided.

    Attributes:
        setpoints: for the driver.
        trajectory: the model's trajectory behind them.
        cost: of the trajectory.
        step_size: of the line search, 0 when the last plan stands.
        regularisation: in use.
        iteration_ms: wall clock.
        warning: empty when all is well.
    """

    setpoints: Setpoints
    trajectory: Trajectory
    cost: float
    step_size: float
    regularisation: float
    iteration_ms: float
    warning: str = ""


@dataclass
class Memory:
    """What is kept from one iteration to the next."""

    plan: Plan | None = None
    regularisation: float = REGULARISATION


class PackingController:
    """Plans torques for the arm so that the held object reaches its target among the others.

    Args:
        scene: shapes, sizes and masses.
        cell: the cell's physical facts.
        weights: of the residuals.
        config: parameters.
        with_objects: False for Uninformed Physics.
    """

    def __init__(
        self, scene: Scene, cell: PackingCell, weights: WeightSet, config: ControllerConfig, *, with_objects: bool = True
    ) -> None:
        self.config, self._weights, self._robot = config, weights, cell.robot
        self._plant = PackingPlant(
            scene, cell, timestep=config.timestep, threads=config.threads, with_objects=with_objects
        )
        self._memory = Memory()
        self._rng = np.random.default_rng(0)

    def forget_regularisation(self) -> None:
        """A new cost wants a fresh step; the last plan stays, the driver is following it."""
        self._memory.regularisation = REGULARISATION

    def plan(
        self, joints: JointSample, scene: SceneState, stage: Stage, target: Target, stage_age: float, latency: float
    ) -> Plan:
        """One iteration.

        Args:
            joints: newest measurement.
            scene: newest estimate.
            stage: decides the weights.
            target: where the held object shall go.
            stage_age: time since the stage began [s].
            latency: time until the plan will be in force [s]; the state is predicted over it.
        """
        started = wall_clock.perf_counter()
        x0 = predict(self._plant, self._robot, self._plant.state(joints, scene), self._memory.plan, latency)
        cost = self._cost(stage, target, stage_age)
        nominal, warning = self._nominal(cost, x0)
        columns = self._plant.columns(self.touched(nominal))
        candidates = None
        if stage is Stage.INSERT and self.config.explorers.count:
            away = self._away(nominal, target)
            candidates = explore(self._plant, nominal.xs[0], nominal.us, away, self.config.explorers, self._rng)
        result = iterate(
            self._plant, cost, nominal, columns, self._memory.regularisation, self.config.ilqr, candidates
        )
        plan = Plan(
            self._setpoints(result.trajectory), result.trajectory, result.trajectory.cost, result.step_size,
            result.regularisation, 1e3 * (wall_clock.perf_counter() - started), result.warning or warning,
        )  # fmt: skip
        self._memory = Memory(plan, result.regularisation)
        return plan

    def held_position(self, trajectory: Trajectory) -> Array:
        """Positions `(T + 1, 3)` [m] of the held object along a trajectory."""
        return trajectory.ys[:, self._plant.sensor(HELD_POSITION)]

    def _cost(self, stage: Stage, target: Target, stage_age: float) -> PackingCost:
        scale = max(0.0, 1.0 - stage_age / self._weights.obstacle_decay)
        residuals = Residuals(self._plant, self._weights, target)
        return PackingCost(residuals, self._weights.of(stage), self._weights.torque, scale)

    def _nominal(self, cost: PackingCost, x0: Array) -> tuple[Trajectory, str]:
        """The last plan, shifted to now; gravity compensation alone where that diverges."""
        steps, last = self.config.horizon, self._memory.plan
        us = np.zeros((steps, 7))
        if last is not None:
            shift = int(round((x0[0] - last.setpoints.time) / self.config.timestep))
            if 0 <= shift < steps:
                us[: steps - shift] = last.trajectory.us[shift:]
        nominal = evaluate(self._plant, cost, x0, us)
        if _is_sane(nominal, self._plant):
            return nominal, ""
        nominal = evaluate(self._plant, cost, x0, np.zeros((steps, 7)))
        return nominal, "the last plan diverged from here; started afresh"

    def touched(self, nominal: Trajectory) -> list[str]:
        """Objects that move along the nominal trajectory."""
        moved = []
        for name, p in self._plant.layout.object_p.items():
            path = nominal.xs[:, p]
            if np.linalg.norm(path - path[0], axis=1).max() > self.config.touched:
                moved.append(name)
        return moved

    def _away(self, nominal: Trajectory, target: Target) -> Array:
        """Horizontal direction `(2,)` from the obstacles' middle to the held object."""
        obstacles = [self._plant.layout.object_p[name][:2] for name in target.collisions if name in self._plant.layout.object_p]
        if not obstacles:
            return np.zeros(2)
        middle = np.mean([nominal.xs[0, p] for p in obstacles], axis=0)
        offset = self.held_position(nominal)[0, :2] - middle
        return np.asarray(offset / max(float(np.linalg.norm(offset)), 1e-6))

    def _setpoints(self, trajectory: Trajectory) -> Setpoints:
        n, layout = self.config.published, self._plant.layout
        xs = trajectory.xs[:n]
        return Setpoints(
            float(xs[0, 0]), self.config.timestep * np.arange(n), np.clip(xs[:, layout.q], LOWER, UPPER),
            np.clip(xs[:, layout.v], -VELOCITY_LIMITS, VELOCITY_LIMITS),
            np.clip(trajectory.us[:n], -TORQUE_LIMITS, TORQUE_LIMITS),
        )  # fmt: skip


def _is_sane(trajectory: Trajectory, plant: PackingPlant) -> bool:
    speeds = trajectory.xs[:, plant.layout.v]
    return bool(np.isfinite(trajectory.cost) and np.all(np.abs(speeds) < DIVERGED))
