"""Placement planner: where to put the new object so that it disturbs the others least.

Algorithm 1 of Russell, Xu, Roa, Dogar, "Pack it in: Packing into Partially Filled Containers Through
Contact". Two readings of it:

- The collision list G holds the objects that the chosen, settled pose overlaps where they stand now
  (P_0), since those are what the arm has to push aside; line 10 leaves open which pose and state it means.
- The sum of Eq. 6 counts the new object too, from where it was teleported to: one that the physics
  throws on top of another, which then need not move, is not a cheap placement.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import partial
from typing import Literal, cast, get_args

import numpy as np
import numpy.typing as npt
from pydantic import Field, NonNegativeFloat, NonNegativeInt, PositiveFloat, PositiveInt

from pack_core.config import Config
from pack_core.errors import PackError
from pack_core.packing.cell import PackingCell
from pack_core.packing.fit import fitting_yaws
from pack_core.packing.scene import Scene
from pack_core.rotations import Array, Pose, yaw_of
from pack_core.states import SceneState
from pack_planner.placement.approach import ApproachPlanner, beside
from pack_planner.placement.approach_config import ApproachConfig
from pack_planner.placement.feasibility import judge
from pack_planner.placement.placement_result import Candidate, Placement, PlacementStatus, Samples
from pack_planner.placement.pose_sampling import sample_near, sample_poses
from pack_planner.placement.ranking import cheapest_elsewhere, spread_out
from pack_planner.placement.settling import Settling

Variant = Literal["physics", "random"]


class PlacementConfig(Config):
    """Parameters of Algorithm 1, the paper's values by default."""

    variant: Variant = Field("physics", description="physics: Algorithm 1; random: Uninformed Pose")
    samples: PositiveInt = Field(300, description="sampled poses S")
    steps: PositiveInt = Field(30, description="steps M in which overlaps must resolve")
    timestep: PositiveFloat = Field(0.006, description="step of the physics [s]")
    weights: tuple[NonNegativeFloat, NonNegativeFloat, NonNegativeFloat] = Field(
        (1.0, 1.0, 10.0), description="w_x, w_y, w_z on the objects' displacements"
    )
    beta: NonNegativeFloat = Field(1000.0, description="weight of lasting penetration [1/m]")
    resting_penetration: PositiveFloat = Field(
        0.001, description="depth [m] up to which two objects touch; what is deeper has not resolved"
    )
    wall_clearance: NonNegativeFloat = Field(
        0.005, description="placements nearer to a wall [m] are taken only where there are no others"
    )
    threads: NonNegativeInt = Field(0, description="threads of the physics; 0: all cores")
    approach: ApproachConfig = ApproachConfig()


class PlacementPlanner:
    """Plans placements of one scene's new object."""

    def __init__(self, scene: Scene, cell: PackingCell, config: PlacementConfig) -> None:
        """Build the physics of `scene`, whose poses do not matter.

        Raises:
            PackError: the new object does not fit into the container.
        """
        self._scene, self._config = scene, config
        fitting_yaws(scene.new_object, scene.container, 0.0)
        self._approach = ApproachPlanner(scene, cell, config.approach, config.threads)
        self._settling = Settling(scene, cell, config.timestep, config.threads)

    def plan(
        self, state: SceneState, rng: np.random.Generator, *, lean: float = 0.0,
        variant: Variant | None = None, avoid: Sequence[npt.ArrayLike] = (), avoid_radius: float = 0.02,
    ) -> Placement:  # fmt: skip
        """Choose a placement.

        Args:
            state: where the objects are, the new one included; taken to be at rest.
            rng: decides the samples.
            lean: how far the object will be tilted at its entry [rad].
            variant: overrides the configured one.
            avoid: points `(3,)` [m] tried before; a sample within `avoid_radius` of one, as seen from
                above, is taken only if all are, and then the farthest.
            avoid_radius: [m]

        Raises:
            PackError: `state` lacks an object, or has one that the scene does not know.
        """
        poses = self._checked(state)
        now = self._settling.start(poses)
        new, container = self._scene.new_object, self._scene.container
        sampled = sample_poses(new, container, self._config.samples, yaw_of(poses[new.name].q), rng)
        if (variant or self._config.variant) == "random":
            k = cheapest_elsewhere(np.zeros(len(sampled)), sampled, avoid, avoid_radius)[0]
            samples, _ = self._evaluate(now, sampled[[k]])
            candidate = self._candidate(now, sampled[k], samples.costs[0])
            return _success(beside(candidate, poses), 0, samples)
        samples, reason = self._evaluate(now, sampled)
        feasible = np.flatnonzero(samples.is_feasible)
        if not len(feasible):
            return Placement(
                PlacementStatus.NO_FEASIBLE_PLACEMENT, reason, None, (), np.zeros(2), np.inf, 0, samples
            )
        costs, settled = samples.costs[feasible], samples.settled[feasible]
        ranked = feasible[cheapest_elsewhere(costs, settled, avoid, avoid_radius)]
        approach = self._config.approach
        spread = spread_out(ranked, samples.settled, approach.spacing, approach.tried)
        candidates = self._candidates(now, samples, spread)
        vary = partial(self._near, now, rng)
        return _success(*self._approach.choose(candidates, vary, poses, lean, len(avoid)), samples)

    def _checked(self, state: SceneState) -> dict[str, Pose]:
        poses, known = state.poses(), self._settling.names
        wrong = {
            "lacks": [name for name in known if name not in poses],
            "has unknown": [name for name in poses if name not in known],
        }
        for what, names in wrong.items():
            if names:
                raise PackError(f"the scene's state {what} {names}; the cell's description has {known}")
        return poses

    def _evaluate(self, now: Array, sampled: Array) -> tuple[Samples, str]:
        """Settle every sample and judge it; the reason says why none would do."""
        teleported = self._settling.teleport(now, sampled)
        states = self._settling.settle(teleported, self._config.steps)
        before, settled = self._settling.poses(teleported), self._settling.poses(states)
        penetration = np.array([self._lasting_penetration(row) for row in states])
        costs = self.disturbance(before, settled) + self._config.beta * penetration
        verdict = judge(self._scene, settled, penetration)
        return Samples(sampled, settled[:, -1], costs, verdict.is_feasible), verdict.reason()

    def disturbance(self, before: Array, settled: Array) -> Array:
        """First term of Eq. 6 `(S,)`: weighted displacements of all objects `(S, objects, 7)`."""
        displacements = (settled - before)[..., :3] * np.array(self._config.weights)
        return np.asarray(np.linalg.norm(displacements, axis=-1).sum(axis=-1))

    def _lasting_penetration(self, state: Array) -> float:
        """K of Eq. 6 [m]: depth beyond that of resting contact, summed over touching pairs."""
        depths = np.array(list(self._settling.penetrations(state).values()))
        return float(np.maximum(depths - self._config.resting_penetration, 0.0).sum())

    def _near(self, now: Array, rng: np.random.Generator, candidate: Candidate) -> list[Candidate]:
        """Feasible placements near a candidate."""
        new, container, approach = self._scene.new_object, self._scene.container, self._config.approach
        sampled = sample_near(candidate.X_WN, new, container, approach.variations, approach.deviation, rng)
        samples, _ = self._evaluate(now, sampled)
        return self._candidates(now, samples, np.flatnonzero(samples.is_feasible))

    def _candidates(self, now: Array, samples: Samples, chosen: Iterable[int]) -> list[Candidate]:
        return [self._candidate(now, samples.settled[k], samples.costs[k]) for k in chosen]

    def _candidate(self, now: Array, pose: Array, cost: float) -> Candidate:
        teleported = self._settling.teleport(now, pose[None])[0]
        depths = self._settling.penetrations(teleported)
        new = self._scene.new_object.name
        overlapped = {n for pair, depth in depths.items() if new in pair and depth > 0.0 for n in pair}
        collisions = tuple(name for name in self._scene.names if name in overlapped)
        return Candidate(Pose(pose[:3], pose[3:]), collisions, float(cost))


def _success(found: Candidate, rounds: int, samples: Samples) -> Placement:
    return Placement(
        PlacementStatus.SUCCESS, "", found.X_WN, found.collisions, found.over, found.cost, rounds, samples
    )


def checked_variant(name: str) -> Variant:
    """The variant called `name`.

    Raises:
        PackError: there is none.
    """
    if name not in get_args(Variant):
        raise PackError(f"variant is '{name}'; allowed: {', '.join(get_args(Variant))}")
    return cast(Variant, name)
