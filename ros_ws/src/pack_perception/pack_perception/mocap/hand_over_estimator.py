"""Poses of all objects while others come into the cell, are gripped, and are let go."""

from __future__ import annotations

import numpy as np

from pack_core.packing.model import HeldRole, held_pose
from pack_core.packing.scene import Scene
from pack_core.rotations import Pose
from pack_perception.mocap.grip_tracker import GripTracker
from pack_perception.mocap.guided_cell import GuidedCell
from pack_perception.mocap.physics_estimator import PhysicsEstimator
from pack_perception.mocap.sighting import MarkerTable


class HandOverEstimator(PhysicsEstimator):
    """A `PhysicsEstimator` whose objects change while it runs."""

    def change_scene(self, scene: Scene) -> None:
        """Go on with other objects: what is known of those that stay is kept, the others have not been seen.

        Args:
            scene: the new description. Its new object is free if it is handed over, else on the cup.
        """
        if self._joints is None:
            self._scene, self._markers = scene, MarkerTable(scene)
            self._start_over()
            return
        poses, twists = self._estimates()
        stay = _staying(scene)
        known = {n: i for i, n in enumerate(self._markers.names) if self._is_known[i] and n in stay}
        seen, fitted, grip = self._seen, self._fitted, self._grip
        if (scene.new_object, scene.grip) != (self._scene.new_object, self._scene.grip):
            grip = GripTracker(self._config.grip, held_pose(scene), is_held=not scene.is_handed_over)
        self._scene, self._markers = scene, MarkerTable(scene)
        self._seen, self._fitted = np.full((2, len(self._markers.names)), -np.inf)
        for row, name in enumerate(self._markers.names):
            if name in known:
                self._seen[row], self._fitted[row] = seen[known[name]], fitted[known[name]]
        self._grip = grip
        role = HeldRole.RIGID if grip.is_held else HeldRole.FREE
        self._use(GuidedCell(scene, self._cell, role, self._config.step))
        if grip.is_held:
            self._physics.set_grip(grip.X_TN)
        kept = [name for name in self._physics.free if name in known]
        rows = np.array([self._physics.free.index(name) for name in kept], dtype=int)
        old = [known[name] for name in kept]
        self._physics.correct(rows, poses[old], twists[old])
        self._note(self._joints)

    def take_hold(self) -> Pose | None:
        """The pump has gripped the new object: it hangs on the cup from now on, where it is seen now.

        Returns:
            X_TN, how it hangs; None if it was never seen, or hangs already.
        """
        name = self._scene.new_object.name
        row = self._markers.names.index(name)
        if self._joints is None or self.is_held or not self._is_known[row]:
            return None
        p, q = np.split(self._estimates()[0][row], [3])
        X_TN = self._physics.cup_pose(self._physics.qpos).inverse() @ Pose(p, q)
        self.change_scene(self._scene.gripped(X_TN))
        return X_TN

    def let_go(self) -> None:
        """The pump has opened: the new object is free from now on."""
        if self._joints is not None and self.is_held:
            self._grip.is_held = False
            self._let_go()


def _staying(scene: Scene) -> set[str]:
    """Names of the objects that may have been seen before: one that is handed over is another one."""
    return {*scene.names} if scene.is_handed_over else {*scene.names, scene.new_object.name}
