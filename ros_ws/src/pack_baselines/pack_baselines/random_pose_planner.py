"""The placement planner of a baseline of the paper (Russell, Xu, Roa, Dogar, "Pack it in", section IV-A).

Uninformed Pose "does not use the placement planner as described in Alg. 1, instead it simply randomly chooses
a packing pose inside the container. Importantly it still adds any corresponding objects in collision with the
packing pose to the collision list G." It lacks the planner alone: the controller knows every object, and the
held one leans over its obstacles as PackItIn's does. Its entry is never rehearsed, for that would choose the
pose. The cost of the pose (Eq. 6) is computed for the report and decides nothing.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from pack_core.packing.cell import PackingCell
from pack_core.packing.scene import Scene
from pack_core.rotations import Pose
from pack_core.states import SceneState
from pack_planner.placement.approach_options import beside
from pack_planner.placement.least_disturbance_planner import cheapest_elsewhere
from pack_planner.placement.placement_evaluation import PlacementConfig, PlacementEvaluation
from pack_planner.placement.placement_result import PlannedPlacement


class RandomPosePlanner:
    """Takes the first random pose that was not tried before; implements `PlacementPlanner`."""

    def __init__(self, scene: Scene, cell: PackingCell, config: PlacementConfig) -> None:
        self._evaluation = PlacementEvaluation(scene, cell, config)

    def plan(
        self, state: SceneState, rng: np.random.Generator, *, lean: float = 0.0,
        avoid: Sequence[npt.ArrayLike] = (), avoid_radius: float = 0.02, near: Pose | None = None,
    ) -> PlannedPlacement:  # fmt: skip
        """A random pose, leaning towards the objects that it overlaps; `near` has no influence."""
        poses, now = self._evaluation.start(state)
        sampled = self._evaluation.sample(poses, rng)
        # at equal costs the order is that of the samples, so this is the first one away from `avoid`
        k = cheapest_elsewhere(np.zeros(len(sampled)), sampled, avoid, avoid_radius)[0]
        samples, _ = self._evaluation.evaluate(now, sampled[[k]])
        candidate = self._evaluation.candidate(now, sampled[k], samples.costs[0])
        return PlannedPlacement.success(beside(candidate, poses, lean), 0, samples)
