"""Algorithm 1, and among its best placements the one that can be entered: PackItIn's planner.

Russell, Xu, Roa, Dogar, "Pack it in: Packing into Partially Filled Containers Through Contact". Three points
of Algorithm 1 are read as follows:

- The collision list G holds the objects that the chosen, settled pose overlaps where they stand now (P_0),
  because those are the objects that the arm has to push aside. Line 10 leaves open which pose and state it
  means.
- The sum of Eq. 6 includes the new object, whose displacement counts from where it was teleported to.
  Otherwise a placement at which the physics throws it on top of an object, which then need not move, would
  be cheap.
- The minimum of line 14 is over the feasible samples only (`feasibility.py`); where there are none, there is
  no placement.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import partial

import numpy as np
import numpy.typing as npt

from pack_core.packing.cell import PackingCell
from pack_core.packing.scene import Scene
from pack_core.rotations import Array, Pose
from pack_core.states import SceneState
from pack_planner.placement.approach import ApproachPlanner
from pack_planner.placement.placement_evaluation import PlacementConfig, PlacementEvaluation, sample_near
from pack_planner.placement.placement_result import PlacementCandidate, PlacementSamples, PlannedPlacement


class LeastDisturbancePlanner:
    """Algorithm 1 followed by rehearsed entries; implements `PlacementPlanner`."""

    def __init__(self, scene: Scene, cell: PackingCell, config: PlacementConfig) -> None:
        self._scene, self._config = scene, config
        self._evaluation = PlacementEvaluation(scene, cell, config)
        self._approach = ApproachPlanner(scene, cell, config.approach, config.threads)

    def plan(
        self, state: SceneState, rng: np.random.Generator, *, lean: float = 0.0,
        avoid: Sequence[npt.ArrayLike] = (), avoid_radius: float = 0.02, near: Pose | None = None,
    ) -> PlannedPlacement:  # fmt: skip
        """The cheapest feasible sample that can be entered (Eq. 6).

        The pose `near` is wanted at first, and no more once a placement has failed.
        """
        poses, now = self._evaluation.start(state)
        near = None if len(avoid) else near
        samples, reason = self._evaluation.evaluate(now, self._evaluation.sample(poses, rng, near), near)
        ranked, approach = ranked_feasible(samples, avoid, avoid_radius), self._config.approach
        if not len(ranked):
            return PlannedPlacement.failure(reason, samples)
        spread = spread_out(ranked, samples.settled, approach.spacing, approach.candidates)
        candidates = self._candidates(now, samples, spread)
        vary = partial(self._near, now, rng, near, avoid, avoid_radius)
        chosen, rehearsals = self._approach.choose(candidates, vary, poses, lean, len(avoid), rng)
        return PlannedPlacement.success(chosen, rehearsals, samples)

    def _near(
        self, now: Array, rng: np.random.Generator, wanted: Pose | None, avoid: Sequence[npt.ArrayLike],
        avoid_radius: float, candidate: PlacementCandidate,
    ) -> list[PlacementCandidate]:  # fmt: skip
        """Feasible placements near a candidate, away from `avoid` as it is."""
        new, container, approach = self._scene.new_object, self._scene.container, self._config.approach
        sampled = sample_near(candidate.X_WN, new, container, approach.variations, approach.deviation, rng)
        samples, _ = self._evaluation.evaluate(now, sampled, wanted)
        is_away = distances_to(samples.settled, avoid) >= avoid_radius
        return self._candidates(now, samples, np.flatnonzero(samples.is_feasible & is_away))

    def _candidates(
        self, now: Array, samples: PlacementSamples, chosen: Iterable[int]
    ) -> list[PlacementCandidate]:
        evaluation = self._evaluation
        return [evaluation.candidate(now, samples.settled[k], samples.costs[k]) for k in chosen]


def ranked_feasible(
    samples: PlacementSamples, avoid: Sequence[npt.ArrayLike], radius: float
) -> npt.NDArray[np.int_]:
    """Indices of the feasible samples away from `avoid`, the cheapest first (line 14)."""
    feasible = np.flatnonzero(samples.is_feasible)
    if not len(feasible):
        return feasible
    return feasible[cheapest_elsewhere(samples.costs[feasible], samples.settled[feasible], avoid, radius)]


def cheapest_elsewhere(
    costs: Array, poses: Array, avoid: Sequence[npt.ArrayLike], radius: float
) -> npt.NDArray[np.int_]:
    """Indices of the poses `(n, 7)` that are near none of the points `avoid`, the cheapest first.

    Near means within `radius` [m], as seen from above. If all poses are near one, the farthest is returned.
    """
    if not len(avoid):
        return np.argsort(costs, kind="stable")
    distances = distances_to(poses, avoid)
    elsewhere = np.flatnonzero(distances >= radius)
    if not len(elsewhere):
        return np.array([np.argmax(distances)])
    return elsewhere[np.argsort(costs[elsewhere], kind="stable")]


def spread_out(ranked: npt.NDArray[np.int_], poses: Array, spacing: float, n: int) -> list[int]:
    """At most `n` of the indices `ranked`, reordered in layers so that neighbours come late.

    The first layer has the poses of `(S, 7)` that keep a distance of `spacing` [m], as seen from above, from
    every better one in the same layer. The next layer is made of the remaining poses likewise, and so on.
    """
    chosen: list[int] = []
    rest = ranked.tolist()
    while rest and len(chosen) < n:
        layer, rest = _layer(rest, poses[:, :2], spacing)
        chosen += layer
    return chosen[:n]


def _layer(ranked: Sequence[int], points: Array, spacing: float) -> tuple[list[int], list[int]]:
    """The indices that keep `spacing` from all better ones in the layer, and the remaining ones."""
    layer: list[int] = []
    rest: list[int] = []
    for k in ranked:
        is_near = len(layer) and np.linalg.norm(points[layer] - points[k], axis=1).min() <= spacing
        (rest if is_near else layer).append(k)
    return layer, rest


class Algorithm1Planner:
    """Algorithm 1 alone: the cheapest feasible sample (Eq. 6), entered straight from above.

    A fill job judges by it whether an object fits at all. The paper's baseline Uninformed Physics has it,
    too: that one "still receives an informative packing pose from Alg. 1", and nothing else about the
    objects, so it looks neither for a side to lean to nor for a way down.
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
        samples, reason = self._evaluation.evaluate(now, self._evaluation.sample(poses, rng, near), near)
        ranked = ranked_feasible(samples, avoid, avoid_radius)
        if not len(ranked):
            return PlannedPlacement.failure(reason, samples)
        best = int(ranked[0])
        candidate = self._evaluation.candidate(now, samples.settled[best], samples.costs[best])
        return PlannedPlacement.success(candidate, 0, samples)


def distances_to(poses: Array, avoid: Sequence[npt.ArrayLike]) -> Array:
    """Distance `(n,)` of poses `(n, 7)` to the nearest of points, from above [m]; infinite without any."""
    tried = np.array([np.asarray(point)[:2] for point in avoid], dtype=float).reshape(-1, 2)
    distances = np.linalg.norm(poses[:, None, :2] - tried, axis=-1)
    return np.asarray(distances.min(axis=1, initial=np.inf))
