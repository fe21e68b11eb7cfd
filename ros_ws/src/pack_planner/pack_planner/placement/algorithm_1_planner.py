"""Algorithm 1: put the new object where it disturbs the others least.

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

from collections.abc import Mapping, Sequence

import numpy as np
import numpy.typing as npt

from pack_core.packing.cell import PackingCell
from pack_core.packing.scene import Scene
from pack_core.rotations import Array, Pose
from pack_core.states import SceneState
from pack_planner.placement.placement_config import PlacementConfig
from pack_planner.placement.placement_evaluation import PlacementEvaluation
from pack_planner.placement.placement_result import PlacementSamples, PlannedPlacement
from pack_planner.placement.ranking import cheapest_elsewhere


class Algorithm1Planner:
    """The cheapest feasible sample (Eq. 6), entered straight from above; implements `PlacementPlanner`.

    Uninformed Physics, a baseline of section IV-A, "still receives an informative packing pose from Alg. 1",
    and nothing else about the objects: this planner looks neither for a side to lean to nor for a way down.
    """

    def __init__(self, scene: Scene, cell: PackingCell, config: PlacementConfig) -> None:
        self._evaluation = PlacementEvaluation(scene, cell, config)

    def plan(
        self, state: SceneState, rng: np.random.Generator, *, lean: float = 0.0,
        avoid: Sequence[npt.ArrayLike] = (), avoid_radius: float = 0.02, near: Pose | None = None,
    ) -> PlannedPlacement:  # fmt: skip
        """The cheapest feasible sample away from `avoid`; `lean` has no influence here.

        The pose `near` is wanted at first, and no more once a placement has failed.
        """
        poses, now = self._evaluation.start(state)
        near = None if len(avoid) else near
        samples, reason = self._evaluation.evaluate(now, self._sampled(poses, rng, near), near)
        ranked = self._ranked(samples, avoid, avoid_radius)
        if not len(ranked):
            return PlannedPlacement.failure(reason, samples)
        best = int(ranked[0])
        candidate = self._evaluation.candidate(now, samples.settled[best], samples.costs[best])
        return PlannedPlacement.success(candidate, 0, samples)

    def _sampled(self, poses: Mapping[str, Pose], rng: np.random.Generator, near: Pose | None) -> Array:
        """Poses `(S, 7)` to evaluate: about `near`, or anywhere."""
        if near is None:
            return self._evaluation.sample(poses, rng)
        return self._evaluation.sample_about(near, rng)

    def _ranked(
        self, samples: PlacementSamples, avoid: Sequence[npt.ArrayLike], radius: float
    ) -> npt.NDArray[np.int_]:
        """Indices of the feasible samples away from `avoid`, the cheapest first (line 14)."""
        feasible = np.flatnonzero(samples.is_feasible)
        if not len(feasible):
            return feasible
        costs, settled = samples.costs[feasible], samples.settled[feasible]
        return feasible[cheapest_elsewhere(costs, settled, avoid, radius)]
