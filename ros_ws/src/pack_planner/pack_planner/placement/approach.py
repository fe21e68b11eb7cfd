"""Chooses which of the best placements can be entered, and to which side the object leans.

Algorithm 1 judges where the new object ends, not how it gets there: on its way it may land on what it was to
push aside. Here the entries of its best placements are rehearsed in simulation, leaning to several sides.
The good ones are rehearsed again with their goals a few millimetres off. Further rounds rehearse variations
of the best entry so far and further placements. While every entry fails, as where hardly anything is left of
the base, they rehearse random entries that begin over gaps: any side, any offset, some steeper.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import islice

import numpy as np
from pydantic import Field, NonNegativeFloat, NonNegativeInt, PositiveFloat, PositiveInt

from pack_core.config import Config
from pack_core.packing.cell import PackingCell
from pack_core.packing.entry import Entry, plan_entry
from pack_core.packing.free_space import footprint
from pack_core.packing.scene import Scene
from pack_core.rotations import Array, Pose
from pack_planner.placement.approach_options import Vary, beside, covered, random_ways, to_every_side, varied
from pack_planner.placement.placement_result import PlacementCandidate
from pack_planner.placement.rehearsal import Rehearsal

OFF: Array = np.array([[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -1.0, 0.0]])
"""Directions `(x, y, z)` in which a rehearsal is repeated with its goal off by `error`."""
FAILURE = 1.0
"""What a failed rehearsal adds to a score: the unit in which `resistance`, `good` and `fair` are given."""
HOPELESS = 2.0 * FAILURE
"""An entry with this score or more fails; variations of it are not rehearsed."""


class ApproachConfig(Config):
    """Parameters of the rehearsals."""

    crowded: NonNegativeFloat = Field(
        0.5,
        description="covered share of the base from which on the first placement is rehearsed, too; "
        "one with obstacles all around always is",
    )
    likely: PositiveInt = Field(
        3, description="placements rehearsed in the first round, leaning over their obstacles"
    )
    rounds: NonNegativeInt = Field(
        8, description="most rounds of rehearsals after the first; 0: nothing is rehearsed"
    )
    candidates: PositiveInt = Field(40, description="placements that are considered, the cheapest first")
    drawn: PositiveInt = Field(400, description="random entries drawn in a round while every entry fails")
    random: PositiveInt = Field(
        40, description="how many of them are rehearsed: those that begin most nearly over gaps"
    )
    fresh: PositiveInt = Field(
        3, description="new placements in a round beside variations of the best so far"
    )
    spacing: PositiveFloat = Field(0.01, description="least distance between candidates, seen from above [m]")
    variations: PositiveInt = Field(
        6, description="variations of the best placement so far in each further round"
    )
    deviation: tuple[PositiveFloat, PositiveFloat] = Field(
        (0.006, 0.1), description="standard deviation of variations: position [m] and yaw [rad]"
    )
    compliant_tip: bool = Field(
        False, description="whether rehearsals have the compliance of the cell's cup, or a rigid grip"
    )
    sides: PositiveInt = Field(8, description="directions in which the object may lean")
    finalists: PositiveInt = Field(
        6, description="best entries of a round that are rehearsed again, perturbed"
    )
    error: NonNegativeFloat = Field(0.006, description="perturbation of these rehearsals [m]")
    resistance: NonNegativeFloat = Field(
        10.0,
        description="weight of the lag in a score, in which a failed rehearsal counts 1 [1 / (m s)]; "
        "a lag is 0.015 m s without resistance, 0.06 at the limit",
    )
    good: NonNegativeFloat = Field(0.45, description="score below which the search ends at once")
    fair: NonNegativeFloat = Field(
        0.8, description="score below which the search ends after a round without a better entry"
    )


class ApproachPlanner:
    """Chooses placement and entry of one scene's new object by rehearsals."""

    def __init__(self, scene: Scene, cell: PackingCell, config: ApproachConfig, threads: int) -> None:
        self._scene, self._config = scene, config
        modelled = cell if config.compliant_tip else cell.model_copy(update={"tip": None})
        self._rehearsal = Rehearsal(scene, modelled, threads)

    def choose(
        self,
        candidates: Sequence[PlacementCandidate],
        vary: Vary,
        poses: Mapping[str, Pose],
        lean: float,
        failures: int,
        rng: np.random.Generator,
    ) -> tuple[PlacementCandidate, int]:
        """Choose a candidate and the way in.

        Args:
            candidates: the cheapest first, at least one.
            vary: samples feasible placements near a given one.
            poses: X_WO of the objects in the container.
            lean: tilt at the entry [rad].
            failures: placements that failed before.
            rng: source of the random entries.

        Returns:
            The choice, and the number of rehearsals; 0 if none was needed.
        """
        first = beside(candidates[0], poses, lean)
        if self._is_likely(first, poses, failures) or not self._config.rounds:
            return first, 0
        before = self._rehearsal.count
        likely = [beside(candidate, poses, lean) for candidate in candidates[: self._config.likely]]
        best, lowest = self._cheapest(likely, poses)
        config, fresh, rounds, enough = self._config, iter(candidates), 1, self._config.good
        while rounds <= config.rounds and lowest >= enough:
            if lowest >= HOPELESS:
                options = self._over_gaps(candidates, poses, lean, rng)
            else:
                further = islice(fresh, config.fresh)
                options = to_every_side(further, poses, lean, config.sides) + varied(best, vary)
            if not options:
                break
            option, score = self._cheapest(options, poses)
            rounds, enough = rounds + 1, config.good if score < lowest else config.fair
            if score < lowest:
                best, lowest = option, score
        return best, self._rehearsal.count - before

    def _over_gaps(
        self,
        candidates: Sequence[PlacementCandidate],
        poses: Mapping[str, Pose],
        lean: float,
        rng: np.random.Generator,
    ) -> list[PlacementCandidate]:
        """Of many random entries those that begin most nearly over gaps."""
        drawn = random_ways(candidates, lean, self._config.drawn, rng)
        first = np.argsort(covered(self._scene, poses, drawn), kind="stable")[: self._config.random]
        return [drawn[k] for k in first]

    def _cheapest(
        self, options: Sequence[PlacementCandidate], poses: Mapping[str, Pose]
    ) -> tuple[PlacementCandidate, float]:
        """The best entry of a round, and its score.

        Every entry is rehearsed as planned, and if one succeeds, the best `finalists` again with their goals
        shifted in each direction of `OFF`. The score is the cost (Eq. 6) + r as planned + the mean of r over
        the directions, where r = `resistance` * lag, + 1 if the entry fails; without the shifted ones, 2 r.
        """
        entries = [plan_entry(self._scene, o.X_WN, o.collisions, poses, o.way) for o in options]
        costs = np.array([option.cost for option in options])
        planned = self._rehearse(options, entries, np.zeros((1, 3)), poses)[0]
        best = np.argsort(costs + planned, kind="stable")[: self._config.finalists]
        off = planned[best]
        if (off < FAILURE).any():
            finalists = [options[i] for i in best]
            shifts = self._config.error * OFF
            off = self._rehearse(finalists, [entries[i] for i in best], shifts, poses).mean(axis=0)
        scores = costs[best] + planned[best] + off
        k = int(np.argmin(scores))
        return options[best[k]], float(scores[k])

    def _rehearse(
        self,
        options: Sequence[PlacementCandidate],
        entries: Sequence[Entry],
        shifts: Array,
        poses: Mapping[str, Pose],
    ) -> Array:
        """The part r of the scores of n entries `(m, n)`, their goals off by `shifts` `(m, 3)` [m]."""
        goals = [Pose(option.X_WN.p + shift, option.X_WN.q) for shift in shifts for option in options]
        seen = self._rehearsal.run(poses, goals, [*entries] * len(shifts))
        r = self._config.resistance * seen.lags + FAILURE * ~seen.is_success
        return np.asarray(r).reshape(len(shifts), -1)

    def _is_likely(self, first: PlacementCandidate, poses: Mapping[str, Pose], failures: int) -> bool:
        """Whether the first placement needs no rehearsal: there is room, and a side to lean to."""
        is_surrounded = bool(first.collisions) and not first.way.over.any()
        return not failures and not is_surrounded and self._covered(first, poses) < self._config.crowded

    def _covered(self, candidate: PlacementCandidate, poses: Mapping[str, Pose]) -> float:
        """Share of the container's base that the objects cover, the new one included."""
        scene = self._scene
        standing = [footprint(scene.model_of(name), poses[name]) for name in scene.names]
        area = sum(outline.area for outline in (*standing, footprint(scene.new_object, candidate.X_WN)))
        return float(area / np.prod(scene.container.size))
