"""Physics of Algorithm 1: teleports the new object and simulates until overlapping objects part."""

from __future__ import annotations

import numpy as np

from pack_core.packing.cell import PackingCell
from pack_core.packing.model import HeldRole
from pack_core.packing.scene import Scene
from pack_core.rotations import Array, Pose
from pack_planner.placement.batch_physics import BatchPhysics


class Settling:
    """The scene without the arm, simulated for many poses of the new object at once.

    Objects are numbered as in the scene, the new object last.
    """

    def __init__(self, scene: Scene, cell: PackingCell, timestep: float, threads: int) -> None:
        """Build the model; `threads` 0 uses all cores."""
        self.names = [*scene.names, scene.new_object.name]
        self._physics = BatchPhysics(scene, cell, timestep=timestep, held=HeldRole.FREE, threads=threads)

    def start(self, poses: dict[str, Pose]) -> Array:
        """The state `(nstate,)` with the objects at rest at X_WO."""
        return self._physics.state(poses)

    def teleport(self, state: Array, poses: Array) -> Array:
        """States `(n, nstate)` equal to `state` except for the new object's pose `(n, 7)`."""
        states = np.tile(state, (len(poses), 1))
        self._object_poses(states)[:, -1] = poses
        return states

    def settle(self, states: Array, steps: int) -> Array:
        """States `(n, nstate)` after `steps` steps without controls."""
        return np.array(self._physics.rest(states, steps)[:, -1])

    def poses(self, states: Array) -> Array:
        """X_WO of every object `(n, objects, 7)`."""
        return self._object_poses(states).copy()

    def penetrations(self, state: Array) -> dict[tuple[str, str], float]:
        """Deepest penetration [m] of every pair of geoms that touch."""
        return self._physics.penetrations(state)

    def _object_poses(self, states: Array) -> Array:
        """A view `(n, objects, 7)` of the free joints' positions."""
        # the objects' free joints are adjacent in the state, in the order of `names`
        first = self._physics.column(self.names[0])
        return states[:, first : first + 7 * len(self.names)].reshape(len(states), -1, 7)
