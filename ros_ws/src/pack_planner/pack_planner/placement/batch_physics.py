"""Simulates a scene without the arm from many states at once."""

from __future__ import annotations

import os

import mujoco
import numpy as np

from pack_core.bodies import penetrations, set_object_poses
from pack_core.packing.cell import PackingCell
from pack_core.packing.model import ArmRole, HeldRole, build_model
from pack_core.packing.rollouts import SleepingRollouts
from pack_core.packing.scene import Scene
from pack_core.rotations import Array, Pose

STATE = mujoco.mjtState.mjSTATE_FULLPHYSICS


class BatchPhysics:
    """Rollouts of one scene; the results do not depend on the number of threads."""

    def __init__(
        self, scene: Scene, cell: PackingCell, *, timestep: float, held: HeldRole, threads: int
    ) -> None:
        """Build the model; `threads` 0 uses all cores."""
        self._model = build_model(scene, cell, timestep=timestep, arm=ArmRole.ABSENT, held=held)
        self._data = mujoco.MjData(self._model)
        self._rollouts = SleepingRollouts(self._model, threads or len(os.sched_getaffinity(0)))
        self._size = mujoco.mj_stateSize(self._model, STATE)

    def state(self, poses: dict[str, Pose]) -> Array:
        """The state `(nstate,)` with the objects at rest at X_WO."""
        data = self._data
        mujoco.mj_resetData(self._model, data)
        set_object_poses(self._model, data, poses)
        state = np.empty(self._size)
        mujoco.mj_getState(self._model, data, state, STATE)
        return state

    def roll_out(self, states: Array, controls: Array) -> Array:
        """The states `(n, T, nstate)` that follow from `(n, nstate)` under controls `(n, T, nu)`."""
        return self._rollouts.run(states, controls)[0]

    def rest(self, states: Array, steps: int) -> Array:
        """The states `(n, steps, nstate)` that follow from `(n, nstate)` under zero controls."""
        return self.roll_out(states, np.zeros((len(states), steps, self._model.nu)))

    def penetrations(self, state: Array) -> dict[tuple[str, str], float]:
        """Deepest penetration [m] of every pair of geoms that touch."""
        data = self._data
        mujoco.mj_setState(self._model, data, state, STATE)
        return penetrations(self._model, data)

    def column(self, name: str) -> int:
        """Index in a state at which the seven numbers of an object's pose X_WO begin."""
        # a full physics state is time, then qpos, then the rest
        return 1 + int(self._model.joint(name).qposadr[0])
