"""Algorithm 1: put the new object where it disturbs the others least, and rehearse its entry.

Russell, Xu, Roa, Dogar, "Pack it in: Packing into Partially Filled Containers Through Contact". Two points
that the paper leaves open are read as follows:

- The collision list G holds the objects that the chosen, settled pose overlaps where they stand now (P_0),
  because those are the objects that the arm has to push aside. Line 10 leaves open which pose and state it
  means.
- The sum of Eq. 6 includes the new object, whose displacement counts from where it was teleported to.
  Otherwise a placement at which the physics throws it on top of an object, which then need not move, would
  be cheap.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import partial

import numpy as np
import numpy.typing as npt

from pack_core.packing.cell import PackingCell
from pack_core.packing.scene import Scene
from pack_core.rotations import Array, yaw_of
from pack_core.states import SceneState
from pack_planner.placement.approach import ApproachPlanner
from pack_planner.placement.placement_config import PlacementConfig
from pack_planner.placement.placement_evaluation import PlacementEvaluation
from pack_planner.placement.placement_result import (
    PlacementCandidate,
    PlacementSamples,
    PlannedPlacement,
)
from pack_planner.placement.pose_sampling import sample_near, sample_poses
from pack_planner.placement.ranking import cheapest_elsewhere, spread_out


class LeastDisturbancePlanner:
    """Algorithm 1 followed by rehearsed entries; implements `PlacementPlanner`."""

    def __init__(self, scene: Scene, cell: PackingCell, config: PlacementConfig) -> None:
        self._scene, self._config = scene, config
        self._evaluation = PlacementEvaluation(scene, cell, config)
        self._approach = ApproachPlanner(scene, cell, config.approach, config.threads)

    def plan(
        self, state: SceneState, rng: np.random.Generator, *, lean: float = 0.0,
        avoid: Sequence[npt.ArrayLike] = (), avoid_radius: float = 0.02,
    ) -> PlannedPlacement:  # fmt: skip
        """The cheapest feasible sample that can be entered (Eq. 6)."""
        poses, now = self._evaluation.start(state)
        new, approach = self._scene.new_object, self._config.approach
        yaw = yaw_of(poses[new.name].q)
        sampled = sample_poses(new, self._scene.container, self._config.samples, yaw, rng)
        samples, reason = self._evaluation.evaluate(now, sampled)
        feasible = np.flatnonzero(samples.is_feasible)
        if not len(feasible):
            return PlannedPlacement.failure(reason, samples)
        costs, settled = samples.costs[feasible], samples.settled[feasible]
        ranked = feasible[cheapest_elsewhere(costs, settled, avoid, avoid_radius)]
        spread = spread_out(ranked, samples.settled, approach.spacing, approach.tried)
        candidates = self._candidates(now, samples, spread)
        vary = partial(self._near, now, rng)
        chosen, rounds = self._approach.choose(candidates, vary, poses, lean, len(avoid))
        return PlannedPlacement.success(chosen, rounds, samples)

    def _near(
        self, now: Array, rng: np.random.Generator, candidate: PlacementCandidate
    ) -> list[PlacementCandidate]:
        """Feasible placements near a candidate."""
        new, container, approach = self._scene.new_object, self._scene.container, self._config.approach
        sampled = sample_near(candidate.X_WN, new, container, approach.variations, approach.deviation, rng)
        samples, _ = self._evaluation.evaluate(now, sampled)
        return self._candidates(now, samples, np.flatnonzero(samples.is_feasible))

    def _candidates(
        self, now: Array, samples: PlacementSamples, chosen: Iterable[int]
    ) -> list[PlacementCandidate]:
        evaluation = self._evaluation
        return [evaluation.candidate(now, samples.settled[k], samples.costs[k]) for k in chosen]
