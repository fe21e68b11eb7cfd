"""Algorithm 1 of the paper line by line (Russell, Xu, Roa, Dogar, "Pack it in", section III-C).

What ships reads it otherwise in three points (`pack_planner/placement/least_disturbance_planner.py`). Here

- line 9: the sum of Eq. 6 is over the N objects in the container, without the new one, and its penalty K
  takes nothing off the depth of a contact;
- lines 10 and 11: the new object is teleported again to the pose that was sampled, among the objects as they
  have settled, and the collision list has what it overlaps there;
- line 14: the minimum is over all samples, whether or not the new object has come to stand on the base.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from pack_core.packing.cell import PackingCell
from pack_core.packing.entry import WayIn
from pack_core.packing.scene import Scene
from pack_core.rotations import Array, Pose
from pack_core.states import SceneState
from pack_planner.placement.least_disturbance_planner import cheapest_elsewhere
from pack_planner.placement.placement_evaluation import PlacementConfig, PlacementEvaluation
from pack_planner.placement.placement_result import PlacementSamples, PlannedPlacement

STRAIGHT = WayIn(back=0.0)
"""Upright and straight down onto the packing pose, whatever is there (Eq. 5)."""


class LiteralPlanner:
    """Algorithm 1 as printed; implements `PlacementPlanner`."""

    def __init__(self, scene: Scene, cell: PackingCell, config: PlacementConfig) -> None:
        self._evaluation, self._config = PlacementEvaluation(scene, cell, config), config

    def plan(
        self, state: SceneState, rng: np.random.Generator, *, lean: float = 0.0,
        avoid: Sequence[npt.ArrayLike] = (), avoid_radius: float = 0.02, near: Pose | None = None,
    ) -> PlannedPlacement:  # fmt: skip
        """The cheapest sample of all; `lean` and `near` have no influence."""
        poses, now = self._evaluation.start(state)
        sampled = self._evaluation.sample(poses, rng)  # line 4
        settled, _ = self._evaluation.evaluate(now, sampled)  # lines 5 to 8
        samples = replace(settled, costs=self._costs(settled, poses))
        k = cheapest_elsewhere(samples.costs, samples.settled, avoid, avoid_radius)[0]  # line 14
        again = self._evaluation.at_rest(samples.scenes[k])
        candidate = self._evaluation.candidate(again, sampled[k], samples.costs[k])  # lines 10 and 11
        X_WN = Pose(samples.settled[k, :3], samples.settled[k, 3:])  # line 15
        return PlannedPlacement.success(replace(candidate, X_WN=X_WN, way=STRAIGHT), 0, samples)

    def _costs(self, samples: PlacementSamples, poses: dict[str, Pose]) -> Array:
        """Eq. 6 `(S,)`: the displacements of the objects in the container, and beta times K (line 9)."""
        others = np.array([[*poses[name].p, *poses[name].q] for name in samples.names[:-1]]).reshape(-1, 7)
        moved = self._evaluation.disturbance(others, samples.scenes[:, :-1])
        states = (self._evaluation.at_rest(scene) for scene in samples.scenes)
        K = np.array([self._evaluation.penetration(state, resting=0.0) for state in states])
        return np.asarray(moved + self._config.beta * K)
