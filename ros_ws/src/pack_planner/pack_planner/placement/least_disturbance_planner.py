"""Algorithm 1, and among its best placements the one that can be entered: PackItIn's planner."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import partial

import numpy as np
import numpy.typing as npt

from pack_core.packing.cell import PackingCell
from pack_core.packing.scene import Scene
from pack_core.rotations import Array, Pose
from pack_core.states import SceneState
from pack_planner.placement.algorithm_1_planner import Algorithm1Planner
from pack_planner.placement.approach import ApproachPlanner
from pack_planner.placement.placement_config import PlacementConfig
from pack_planner.placement.placement_result import (
    PlacementCandidate,
    PlacementSamples,
    PlannedPlacement,
)
from pack_planner.placement.pose_sampling import sample_near
from pack_planner.placement.ranking import spread_out


class LeastDisturbancePlanner(Algorithm1Planner):
    """Algorithm 1 followed by rehearsed entries; implements `PlacementPlanner`."""

    def __init__(self, scene: Scene, cell: PackingCell, config: PlacementConfig) -> None:
        super().__init__(scene, cell, config)
        self._scene, self._config = scene, config
        self._approach = ApproachPlanner(scene, cell, config.approach, config.threads)

    def plan(
        self, state: SceneState, rng: np.random.Generator, *, lean: float = 0.0,
        avoid: Sequence[npt.ArrayLike] = (), avoid_radius: float = 0.02, near: Pose | None = None,
    ) -> PlannedPlacement:  # fmt: skip
        """The cheapest feasible sample that can be entered (Eq. 6)."""
        poses, now = self._evaluation.start(state)
        near = None if len(avoid) else near
        samples, reason = self._evaluation.evaluate(now, self._sampled(poses, rng, near), near)
        ranked, approach = self._ranked(samples, avoid, avoid_radius), self._config.approach
        if not len(ranked):
            return PlannedPlacement.failure(reason, samples)
        spread = spread_out(ranked, samples.settled, approach.spacing, approach.candidates)
        candidates = self._candidates(now, samples, spread)
        vary = partial(self._near, now, rng, near)
        chosen, rehearsals = self._approach.choose(candidates, vary, poses, lean, len(avoid), rng)
        return PlannedPlacement.success(chosen, rehearsals, samples)

    def _near(
        self, now: Array, rng: np.random.Generator, wanted: Pose | None, candidate: PlacementCandidate
    ) -> list[PlacementCandidate]:
        """Feasible placements near a candidate."""
        new, container, approach = self._scene.new_object, self._scene.container, self._config.approach
        sampled = sample_near(candidate.X_WN, new, container, approach.variations, approach.deviation, rng)
        samples, _ = self._evaluation.evaluate(now, sampled, wanted)
        return self._candidates(now, samples, np.flatnonzero(samples.is_feasible))

    def _candidates(
        self, now: Array, samples: PlacementSamples, chosen: Iterable[int]
    ) -> list[PlacementCandidate]:
        evaluation = self._evaluation
        return [evaluation.candidate(now, samples.settled[k], samples.costs[k]) for k in chosen]
