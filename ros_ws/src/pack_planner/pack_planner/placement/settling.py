"""Physics of the placement planner: teleport the new object, let the overlaps push each other away."""

from __future__ import annotations

import os

import mujoco
import mujoco.rollout
import numpy as np

from pack_core.cells.packing import PackingCell
from pack_core.rotations import Array, Pose
from pack_core.scene.model import Arm, Held, build_model, penetrations, set_object_poses
from pack_core.scene.scene import Scene

STATE = mujoco.mjtState.mjSTATE_FULLPHYSICS


class Settling:
    """The scene without the arm, simulated for many poses of the new object at once.

    Objects are numbered as in the scene, the new object last.
    """

    def __init__(self, scene: Scene, cell: PackingCell, timestep: float, threads: int) -> None:
        """Build the model; `threads` 0 uses all cores."""
        self.names = [*scene.names, scene.new_object.name]
        self._model = build_model(scene, cell, timestep=timestep, arm=Arm.ABSENT, held=Held.FREE)
        n = threads or len(os.sched_getaffinity(0))
        self._datas = [mujoco.MjData(self._model) for _ in range(n)]
        self._rollout = mujoco.rollout.Rollout(nthread=n)
        self._size = mujoco.mj_stateSize(self._model, STATE)

    def start(self, poses: dict[str, Pose]) -> Array:
        """The state `(nstate,)` with the objects at rest at X_WO."""
        data = self._datas[0]
        mujoco.mj_resetData(self._model, data)
        set_object_poses(self._model, data, poses)
        state = np.empty(self._size)
        mujoco.mj_getState(self._model, data, state, STATE)
        return state

    def teleport(self, state: Array, poses: Array) -> Array:
        """States `(n, nstate)` that differ by the new object's pose `(n, 7)`."""
        states = np.tile(state, (len(poses), 1))
        self._object_poses(states)[:, -1] = poses
        return states

    def settle(self, states: Array, steps: int) -> Array:
        """States `(n, nstate)` after so many steps; the same for any number of threads."""
        path, _ = self._rollout.rollout(self._model, self._datas, states, nstep=steps)
        return np.array(path[:, -1])

    def poses(self, states: Array) -> Array:
        """X_WO of every object `(n, objects, 7)`."""
        return self._object_poses(states).copy()

    def penetrations(self, state: Array) -> dict[tuple[str, str], float]:
        """Deepest penetration [m] of every pair of geoms that touch."""
        data = self._datas[0]
        mujoco.mj_setState(self._model, data, state, STATE)
        return penetrations(self._model, data)

    def _object_poses(self, states: Array) -> Array:
        """A view `(n, objects, 7)` of the free joints' positions."""
        first = 1 + self._model.joint(self.names[0]).qposadr[0]
        return states[:, first : first + 7 * len(self.names)].reshape(len(states), -1, 7)
