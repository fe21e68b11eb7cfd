"""The model predictive controller: one iteration from a measured state to setpoints."""

from __future__ import annotations

import time as wall_clock
from dataclasses import dataclass, replace
from typing import Annotated

import mujoco
import numpy as np
from pydantic import AfterValidator, Field, PositiveFloat

from pack_core.config import Config
from pack_core.joints import JointSample, Setpoints
from pack_core.packing.cell import PackingCell
from pack_core.packing.model import ArmRole
from pack_core.packing.scene import Scene
from pack_core.register import with_sections
from pack_core.rotations import Array
from pack_core.states import SceneState
from pack_mpc.cost.cost import PackingCost, Residuals
from pack_mpc.cost.weights import WeightSet
from pack_mpc.optimizers import OPTIMIZERS
from pack_mpc.optimizers.optimizer import Solution
from pack_mpc.plant import STATE, PackingPlant
from pack_mpc.state_reduction import StateReduction
from pack_mpc.target import PackingTarget, Stage

OptimizerName = Annotated[str, AfterValidator(OPTIMIZERS.known)]
"""A configuration's field that names an optimizer."""


@with_sections({name: optimizer.parameters for name, optimizer in OPTIMIZERS.items()})
class ControllerConfig(Config):
    """Parameters of the controller, and of each optimizer in a section of its name."""

    optimizer: OptimizerName = Field(default="sgn", description="what plans; its name in pack_mpc/optimizers")
    threads: int = Field(default=2, ge=1, description="threads of the rollouts")
    compliant_tip: bool = Field(
        default=False, description="whether the model has the compliance of the cell's cup, or a rigid grip"
    )
    published: PositiveFloat = Field(
        default=0.24, description="part of the horizon that is sent to the driver [s]"
    )


@dataclass(frozen=True)
class ControlPlan:
    """What one iteration decided.

    Attributes:
        setpoints: the part of the solution that is sent to the driver.
        solution: the whole result of the optimizer.
        iteration_ms: wall-clock time that the iteration took [ms].
    """

    setpoints: Setpoints
    solution: Solution
    iteration_ms: float


PREDICTION_STEP = 0.006
"""Time step of the prediction [s]: that of the paper's model (IV-B)."""


class Predictor:
    """Advances a state under the setpoints in flight, those that the driver follows while planning goes on.

    The servos are actuators of the model, which MuJoCo integrates implicitly: computed outside of it, once
    a step, the driver's damping would be unstable at this step length.

    Args:
        scene: shapes, sizes and masses of the objects that are taken into account.
        cell: the cell's physical facts.

    Attributes:
        plant: its model, with all of them.
    """

    def __init__(self, scene: Scene, cell: PackingCell) -> None:
        driven = cell.model_copy(update={"robot": cell.robot.applied})
        self.plant = PackingPlant(scene, driven, timestep=PREDICTION_STEP, threads=1, arm=ArmRole.SERVO)
        self._data = mujoco.MjData(self.plant.model)

    def predict(self, x: Array, setpoints: tuple[Setpoints, ...], latency: float) -> Array:
        """The full state `(nx,)` after `latency` [s], rounded to whole steps.

        Args:
            x: full state `(nx,)`.
            setpoints: setpoints in flight, oldest first, each in force from its own time on; before the
                first of them the arm holds.
            latency: time to predict [s].
        """
        model, layout, data = self.plant.model, self.plant.layout, self._data
        mujoco.mj_resetData(model, data)
        mujoco.mj_setState(model, data, x, STATE)
        hold = Setpoints(x[0], np.zeros(1), x[layout.q][None], np.zeros((1, 7)), np.zeros((1, 7)))
        plans, arm = (hold, *setpoints), layout.v - 1 - model.nq
        for _ in range(round(latency / PREDICTION_STEP)):
            time = data.time + PREDICTION_STEP
            # those that begin within the step count for all of it from its middle on
            in_force = [plan for plan in plans if plan.time <= time - 0.5 * PREDICTION_STEP]
            q_d, v_d, tau_ff = in_force[-1].at(time)
            data.ctrl[:] = np.concatenate([q_d, v_d])
            data.qfrc_applied[arm] = tau_ff
            mujoco.mj_step(model, data)
        state = np.empty(self.plant.nx)
        mujoco.mj_getState(model, data, state, STATE)
        return state


class PackingController:
    """Plans the arm's motion so that the held object reaches its target among the others.

    Args:
        scene: shapes, sizes and masses of the objects that are taken into account.
        cell: the cell's physical facts.
        weights: weights of the residuals.
        config: parameters.
    """

    def __init__(self, scene: Scene, cell: PackingCell, weights: WeightSet, config: ControllerConfig) -> None:
        self._config, self._weights = config, weights
        self._modelled = cell if config.compliant_tip else cell.model_copy(update={"tip": None})
        self._in_flight: tuple[Setpoints, ...] = ()
        self._model(scene)

    def _model(self, scene: Scene) -> None:
        """Make the models of a scene and what plans with them."""
        self.scene, config = scene, self._config
        own = getattr(config, config.optimizer)
        self._optimizer = OPTIMIZERS[config.optimizer](scene, self._modelled, own, config.threads)
        self._reduction = StateReduction(self._optimizer.plant, own.reduction)
        self._predictor = Predictor(scene, self._modelled)

    def change_scene(self, scene: Scene) -> None:
        """Go on with other objects, or other shapes of them; what hangs on the cup is the same."""
        last = self._optimizer
        self._model(scene)
        self._optimizer.is_sparing = last.is_sparing
        self._optimizer.go_on_from(last)

    def spare(self, is_sparing: bool) -> None:
        """Do with fewer rollouts from now on, or no longer."""
        self._optimizer.is_sparing = is_sparing

    def change_cost(self) -> None:
        """Tell the optimizer that the stage or the target has changed."""
        self._optimizer.change_cost()

    def plan(
        self,
        joints: JointSample,
        scene: SceneState,
        stage: Stage,
        target: PackingTarget,
        stage_age: float,
        latency: float,
        reliefs: float = 0.0,
    ) -> ControlPlan:
        """Run one iteration.

        Args:
            joints: newest measurement of the joints.
            scene: newest estimate of the objects.
            stage: stage of the task, which decides the weights.
            target: where the held object shall go.
            stage_age: time since the stage began [s].
            latency: time until the plan will be in force [s]; the state is predicted over it.
            reliefs: number of times that the force's weight is relieved; it need not be whole.
        """
        started = wall_clock.perf_counter()
        plant, predictor = self._optimizer.plant, self._predictor
        x = predictor.predict(predictor.plant.state(joints, scene), self._in_flight, latency)
        x0 = self._reduction.reduce(x)
        residuals = Residuals(plant, self._weights, target)
        weights = self._weights.in_force(stage, stage_age, reliefs=reliefs, is_rehearsed=target.is_rehearsed)
        cost = PackingCost(residuals, weights, self._weights.torque)
        solution = self._optimizer.improve(x0, cost, stage, target)
        sent = solution.setpoints.until(self._config.published)
        # The driver follows the plan before until this one begins.
        self._in_flight = (*self._in_flight[-1:], sent)
        # The prediction leaves the press out: it moves the object only once what bears it gives way.
        setpoints = pressing(plant, sent, target.press)
        return ControlPlan(setpoints, solution, 1e3 * (wall_clock.perf_counter() - started))


def pressing(plant: PackingPlant, setpoints: Setpoints, force: float) -> Setpoints:
    """The same setpoints with torques that press the held object down with `force` [N] more.

    A force f on the object takes the joint torques J' f, J the Jacobian of its position where the setpoints
    begin. The torques stay within the arm's limits.
    """
    if not force:
        return setpoints
    limit = plant.arm.limits.effort
    down = plant.held_jacobian(setpoints.q[0])[:3].T @ np.array([0.0, 0.0, -force])
    return replace(setpoints, tau=np.clip(setpoints.fed_forward + down, -limit, limit))
