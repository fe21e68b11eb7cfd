"""Predicts the state at which a plan will be in force, with a model driven as the driver drives the arm."""

from __future__ import annotations

import mujoco
import numpy as np

from pack_core.joints import Setpoints
from pack_core.packing.cell import PackingCell
from pack_core.packing.model import ArmRole
from pack_core.packing.scene import Scene
from pack_core.rotations import Array
from pack_mpc.plant import STATE, PackingPlant

TIMESTEP = 0.006
"""Time step of the prediction [s]."""


class Predictor:
    """Advances a state under the setpoints in flight, those that the driver follows while planning goes on.

    The servos are actuators of the model, which MuJoCo integrates implicitly: computed outside of it, once
    a step, the driver's damping would be unstable at this step length.
    """

    def __init__(self, scene: Scene, cell: PackingCell) -> None:
        driven = cell.model_copy(update={"robot": cell.robot.applied})
        self._plant = PackingPlant(scene, driven, timestep=TIMESTEP, threads=1, arm=ArmRole.SERVO)
        self._data = mujoco.MjData(self._plant.model)

    def predict(self, x: Array, setpoints: tuple[Setpoints, ...], latency: float) -> Array:
        """The full state `(nx,)` after `latency` [s], rounded to whole steps.

        Args:
            x: full state `(nx,)`.
            setpoints: setpoints in flight, oldest first, each in force from its own time on; before the
                first of them the arm holds.
            latency: time to predict [s].
        """
        model, layout, data = self._plant.model, self._plant.layout, self._data
        mujoco.mj_resetData(model, data)
        mujoco.mj_setState(model, data, x, STATE)
        hold = Setpoints(x[0], np.zeros(1), x[layout.q][None], np.zeros((1, 7)), np.zeros((1, 7)))
        plans, arm = (hold, *setpoints), layout.v - 1 - model.nq
        for _ in range(round(latency / TIMESTEP)):
            time = data.time + TIMESTEP
            # those that begin within the step count for all of it from its middle on
            in_force = [plan for plan in plans if plan.time <= time - 0.5 * TIMESTEP]
            q_d, v_d, tau_ff = in_force[-1].at(time)
            data.ctrl[:] = np.concatenate([q_d, v_d])
            data.qfrc_applied[arm] = tau_ff
            mujoco.mj_step(model, data)
        state = np.empty(self._plant.nx)
        mujoco.mj_getState(model, data, state, STATE)
        return state
