"""Chooses which of the best placements can be entered, and to which side the object leans.

Algorithm 1 judges where the new object ends, not how it gets there: on its way it may land on what it was to
push aside. Here the entries of its best placements are rehearsed in simulation, leaning to several sides.
The good ones are rehearsed again with their goals a few millimetres off. Further rounds rehearse variations
of the best entry so far and further placements. While every entry fails, as where hardly anything is left of
the base, they rehearse random entries, too: any side, any offset, some steeper.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import islice

import numpy as np

from pack_core.packing.cell import PackingCell
from pack_core.packing.entry import Entry, WayIn, plan_entry, side_of
from pack_core.packing.free_space import footprint
from pack_core.packing.scene import Scene
from pack_core.rotations import Array, Pose
from pack_planner.placement.approach_config import ApproachConfig
from pack_planner.placement.placement_result import PlacementCandidate
from pack_planner.placement.rehearsal import Rehearsal

OFF: Array = np.array([[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -1.0, 0.0]])
"""Directions `(x, y, z)` in which a rehearsal is repeated with its goal off by `error`."""
RESISTANCE = 10.0
"""Weight of the lag in a score [1 / (m s)]; a lag is 0.015 m s without resistance, 0.06 at the limit."""
GOOD, FAIR = 0.45, 0.8
"""Scores below which the search ends: at once, or after a round without a better entry."""
FAILURE = 1.0
"""What a failed rehearsal adds to a score."""
HOPELESS = 2.0 * FAILURE
"""An entry with this score or more fails; variations of it are not rehearsed."""
TURNS = np.deg2rad([-20.0, 0.0, 20.0])
"""Angles between the sides to which the best entry and its variations lean [rad]."""
STEEPER = 4.0 / 3.0
"""Half of the random entries are tilted this many times as far, but at most halfway to lying flat."""
FARTHEST = 0.08
"""Largest offset of a random entry's lower end [m]."""
Vary = Callable[[PlacementCandidate], list[PlacementCandidate]]
"""Samples feasible placements near a given one."""


class ApproachPlanner:
    """Chooses placement and entry of one scene's new object by rehearsals."""

    def __init__(self, scene: Scene, cell: PackingCell, config: ApproachConfig, threads: int) -> None:
        self._scene, self._config = scene, config
        self._rehearsal = Rehearsal(scene, cell, threads)

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
            The choice, and the number of rounds of rehearsals; 0 if none was needed.
        """
        is_roomy = not failures and self._covered(candidates[0], poses) < self._config.crowded
        if is_roomy or not self._config.rounds:
            return beside(candidates[0], poses, lean), 0
        likely = [beside(candidate, poses, lean) for candidate in candidates[: self._config.likely]]
        best, lowest = self._cheapest(likely, poses)
        fresh, rounds, enough = iter(candidates), 1, GOOD
        while rounds <= self._config.rounds and lowest >= enough:
            if lowest < HOPELESS:
                options = self._further(fresh, self._config.fresh, poses, lean) + _varied(best, vary)
            else:
                options = self._further(fresh, self._config.candidates, poses, lean)
                options += self._random(candidates, lean, rng)
            if not options:
                break
            option, score = self._cheapest(options, poses)
            rounds, enough = rounds + 1, GOOD if score < lowest else FAIR
            if score < lowest:
                best, lowest = option, score
        return best, rounds

    def _further(
        self, fresh: Iterator[PlacementCandidate], n: int, poses: Mapping[str, Pose], lean: float
    ) -> list[PlacementCandidate]:
        """The next n candidates, each once for every side to which it may lean."""
        angles = 2.0 * np.pi * np.arange(self._config.sides) / self._config.sides
        ways = [WayIn(over, lean) for over in _sides(angles)]
        options: list[PlacementCandidate] = []
        for candidate in islice(fresh, n):
            options.append(beside(candidate, poses, lean))
            options += [replace(candidate, way=way) for way in ways if candidate.collisions]
        return options

    def _random(
        self, candidates: Sequence[PlacementCandidate], lean: float, rng: np.random.Generator
    ) -> list[PlacementCandidate]:
        """Random candidates that enter from random sides and offsets."""
        n = self._config.random
        chosen = rng.integers(len(candidates), size=n)
        sides = _sides(rng.uniform(0.0, 2.0 * np.pi, n))
        leans = rng.choice([lean, min(STEEPER * lean, 0.5 * (lean + 0.5 * np.pi))], n)
        backs = rng.uniform(0.0, FARTHEST, n)
        drawn = zip(chosen.tolist(), sides, leans.tolist(), backs.tolist(), strict=True)
        return [replace(candidates[k], way=WayIn(over, tilt, back)) for k, over, tilt, back in drawn]

    def _cheapest(
        self, options: Sequence[PlacementCandidate], poses: Mapping[str, Pose]
    ) -> tuple[PlacementCandidate, float]:
        """The best entry of a round, and its score.

        Every entry is rehearsed as planned, and if one succeeds, the best `finalists` again with their goals
        shifted in each direction of `OFF`. The score is the cost (Eq. 6) + r as planned + the mean of r over
        the directions, where r = `RESISTANCE` * lag, + 1 if the entry fails; without the shifted ones, 2 r.
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
        return np.asarray(RESISTANCE * seen.lags + FAILURE * ~seen.is_success).reshape(len(shifts), -1)

    def _covered(self, candidate: PlacementCandidate, poses: Mapping[str, Pose]) -> float:
        """Share of the container's base that the objects cover, the new one included."""
        scene = self._scene
        standing = [footprint(scene.model_of(name), poses[name]) for name in scene.names]
        area = sum(outline.area for outline in (*standing, footprint(scene.new_object, candidate.X_WN)))
        return float(area / np.prod(scene.container.size))


def beside(candidate: PlacementCandidate, poses: Mapping[str, Pose], lean: float) -> PlacementCandidate:
    """The candidate leaning towards its obstacles, without a rehearsal."""
    return replace(candidate, way=WayIn(side_of(candidate.X_WN, candidate.collisions, poses), lean))


def _varied(best: PlacementCandidate, vary: Vary) -> list[PlacementCandidate]:
    """Placements near the best one, which lean to its side and a little to the left and right of it."""
    turns = TURNS if best.way.over.any() else [0.0]
    ways = [replace(best.way, over=_turned(best.way.over, turn)) for turn in turns]
    return [replace(near, way=way) for near in vary(best) for way in ways]


def _sides(angles: Array) -> Array:
    """The horizontal unit vectors `(n, 2)` in these directions `(n,)` [rad]."""
    return np.stack([np.cos(angles), np.sin(angles)], axis=1)


def _turned(over: Array, angle: float) -> Array:
    """The horizontal vector `(2,)`, turned by an angle [rad]."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s], [s, c]]) @ over
