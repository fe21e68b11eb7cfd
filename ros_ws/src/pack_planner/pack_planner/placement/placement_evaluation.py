"""Lines 3 to 9 of Algorithm 1: the disturbance that placing the new object at a pose causes (Eq. 6)."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from pack_core.errors import PackError
from pack_core.packing.cell import PackingCell
from pack_core.packing.fit import fitting_yaws
from pack_core.packing.scene import Scene
from pack_core.rotations import Array, Pose, yaw_of
from pack_core.states import SceneState
from pack_planner.placement.feasibility import judge
from pack_planner.placement.placement_config import PlacementConfig
from pack_planner.placement.placement_result import PlacementCandidate, PlacementSamples
from pack_planner.placement.pose_sampling import sample_near, sample_poses
from pack_planner.placement.settling import Settling


class PlacementEvaluation:
    """Teleports the new object to sampled poses, simulates until overlaps resolve, and rates the result.

    Args:
        scene: container and objects; their poses do not matter.
        cell: the cell's physical facts.
        config: parameters.

    Raises:
        PackError: the new object does not fit into the container.
    """

    def __init__(self, scene: Scene, cell: PackingCell, config: PlacementConfig) -> None:
        self.scene, self._config = scene, config
        fitting_yaws(scene.new_object, scene.container, 0.0)
        self._settling = Settling(scene, cell, config.timestep, config.threads)

    def start(self, state: SceneState) -> tuple[dict[str, Pose], Array]:
        """X_WO of every object, and the physics state `(nstate,)` with all of them at rest there.

        Raises:
            PackError: `state` lacks an object, or has one that the scene does not know.
        """
        poses, known = state.poses(), self._settling.names
        wrong = {
            "lacks": [name for name in known if name not in poses],
            "has unknown": [name for name in poses if name not in known],
        }
        for what, names in wrong.items():
            if names:
                raise PackError(f"the scene's state {what} {names}; the cell's description has {known}")
        return poses, self._settling.start(poses)

    def sample(self, poses: Mapping[str, Pose], rng: np.random.Generator) -> Array:
        """Random poses `(S, 7)` at which the new object stands in the container, whatever it overlaps."""
        new = self.scene.new_object
        yaw = yaw_of(poses[new.name].q)
        return sample_poses(new, self.scene.container, self._config.samples, yaw, rng)

    def sample_about(self, X_WN: Pose, rng: np.random.Generator) -> Array:
        """Poses `(S, 7)` of the new object scattered about X_WN; the first is X_WN itself."""
        new, config = self.scene.new_object, self._config
        near = sample_near(X_WN, new, self.scene.container, config.near_samples, config.near_deviation, rng)
        return np.vstack([[*X_WN.p, *X_WN.q], near])

    def evaluate(self, now: Array, sampled: Array, near: Pose | None = None) -> tuple[PlacementSamples, str]:
        """Settle poses `(S, 7)` of the new object, and compute their costs and feasibility.

        Args:
            now: the physics state `(nstate,)` before.
            sampled: poses to which the new object is teleported.
            near: the pose X_WN that is wanted, whose distance adds to the cost; None: any.

        Returns:
            The samples, and the reason to give if none of them is feasible.
        """
        teleported = self._settling.teleport(now, sampled)
        states = self._settling.settle(teleported, self._config.steps)
        before, settled = self._settling.poses(teleported), self._settling.poses(states)
        penetration = np.array([self._lasting_penetration(row) for row in states])
        costs = self.disturbance(before, settled) + self._config.beta * penetration
        if near is not None:
            aside = settled[:, -1, :2] - near.p[:2]  # the new object is the last
            costs += self._config.near_weight * np.linalg.norm(aside, axis=1)
        verdict = judge(self.scene, settled, penetration)
        names = tuple(self._settling.names)
        return PlacementSamples(names, sampled, settled, costs, verdict.is_feasible), verdict.reason()

    def candidate(self, now: Array, pose: Array, cost: float) -> PlacementCandidate:
        """A pose `(7,)` of the new object with the objects that it overlaps in the state `now`."""
        teleported = self._settling.teleport(now, pose[None])[0]
        depths = self._settling.penetrations(teleported)
        new = self.scene.new_object.name
        overlapped = {n for pair, depth in depths.items() if new in pair and depth > 0.0 for n in pair}
        collisions = tuple(name for name in self.scene.names if name in overlapped)
        return PlacementCandidate(Pose(pose[:3], pose[3:]), collisions, float(cost))

    def disturbance(self, before: Array, settled: Array) -> Array:
        """First term of Eq. 6 `(S,)`: sum of the weighted displacements of all objects `(S, objects, 7)`."""
        displacements = (settled - before)[..., :3] * np.array(self._config.weights)
        return np.asarray(np.linalg.norm(displacements, axis=-1).sum(axis=-1))

    def _lasting_penetration(self, state: Array) -> float:
        """K of Eq. 6 [m]: depth beyond that of resting contact, summed over touching pairs."""
        depths = np.array(list(self._settling.penetrations(state).values()))
        return float(np.maximum(depths - self._config.resting_penetration, 0.0).sum())
