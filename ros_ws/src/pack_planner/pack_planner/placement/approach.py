"""Chooses which of the best placements can be entered, and to which side the object leans.

Algorithm 1 judges where the new object ends, not how it gets there: on its way it may land on what it was to
push aside. Here the entries of its best placements are rehearsed in simulation, leaning to several sides.
The good ones are rehearsed again with their goals a few millimetres off. Further rounds rehearse variations
of the best entry so far and further placements.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import islice

import numpy as np

from pack_core.packing.cell import PackingCell
from pack_core.packing.entry import Entry, plan_entry, side_of
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
HOPELESS = 2.0
"""An entry with this score or more fails; variations of it are not rehearsed."""
TURNS = np.deg2rad([-20.0, 0.0, 20.0])
"""Angles between the sides to which the best entry and its variations lean [rad]."""
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
    ) -> tuple[PlacementCandidate, int]:
        """Choose a candidate and the side to which the object leans.

        Args:
            candidates: the cheapest first, at least one.
            vary: samples feasible placements near a given one.
            poses: X_WO of the objects in the container.
            lean: tilt at the entry [rad].
            failures: placements that failed before.

        Returns:
            The choice, and the number of rounds of rehearsals; 0 if none was needed.
        """
        is_roomy = not failures and self._covered(candidates[0], poses) < self._config.crowded
        if is_roomy or not self._config.rounds:
            return beside(candidates[0], poses), 0
        likely = [beside(candidate, poses) for candidate in candidates[: self._config.likely]]
        best, lowest = self._cheapest(likely, poses, lean)
        fresh, rounds, enough = iter(candidates), 1, GOOD
        while rounds <= self._most(lowest) and lowest >= enough:
            options = self._round(fresh, best if lowest < HOPELESS else None, vary, poses)
            if not options:
                break
            option, score = self._cheapest(options, poses, lean)
            rounds, enough = rounds + 1, GOOD if score < lowest else FAIR
            if score < lowest:
                best, lowest = option, score
        return best, rounds

    def _most(self, lowest: float) -> int:
        """Largest number of rounds; half of it, rounded up, while every entry so far fails."""
        most = self._config.rounds
        return (most + 1) // 2 if lowest >= HOPELESS else most

    def _round(
        self,
        fresh: Iterator[PlacementCandidate],
        best: PlacementCandidate | None,
        vary: Vary,
        poses: Mapping[str, Pose],
    ) -> list[PlacementCandidate]:
        """Entries of the next round: the next candidates to every side, and variations of the best one."""
        n = self._config.candidates if best is None else self._config.fresh
        options = [option for candidate in islice(fresh, n) for option in self._options(candidate, poses)]
        if best is not None:
            turns = TURNS if best.over.any() else [0.0]
            options += [replace(near, over=_turned(best.over, turn)) for near in vary(best) for turn in turns]
        return options

    def _options(self, candidate: PlacementCandidate, poses: Mapping[str, Pose]) -> list[PlacementCandidate]:
        """The candidate, once for every side to which it may lean."""
        if not candidate.collisions:
            return [candidate]
        angles = 2.0 * np.pi * np.arange(self._config.sides) / self._config.sides
        sides = np.stack([np.cos(angles), np.sin(angles)], axis=1)
        return [beside(candidate, poses), *(replace(candidate, over=over) for over in sides)]

    def _cheapest(
        self, options: Sequence[PlacementCandidate], poses: Mapping[str, Pose], lean: float
    ) -> tuple[PlacementCandidate, float]:
        """The best entry of a round, and its score.

        Every entry is rehearsed as planned, and the best `finalists` of them again with their goals shifted
        in each direction of `OFF`. The score is the cost (Eq. 6) + r as planned + the mean of r over the
        directions, where r = `RESISTANCE` * lag, + 1 if the entry fails.
        """
        entries = [plan_entry(self._scene, o.X_WN, o.collisions, poses, lean, o.over) for o in options]
        scores = np.array([option.cost for option in options])
        scores += self._rehearse(options, entries, np.zeros((1, 3)), poses)[0]
        best = np.argsort(scores, kind="stable")[: self._config.finalists]
        finalists = [options[i] for i in best]
        off = self._rehearse(finalists, [entries[i] for i in best], self._config.error * OFF, poses)
        scores = scores[best] + off.mean(axis=0)
        k = int(np.argmin(scores))
        return finalists[k], float(scores[k])

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
        return np.asarray(RESISTANCE * seen.lags + ~seen.is_success).reshape(len(shifts), -1)

    def _covered(self, candidate: PlacementCandidate, poses: Mapping[str, Pose]) -> float:
        """Share of the container's base that the objects cover, the new one included."""
        scene = self._scene
        standing = [footprint(scene.model_of(name), poses[name]) for name in scene.names]
        area = sum(outline.area for outline in (*standing, footprint(scene.new_object, candidate.X_WN)))
        return float(area / np.prod(scene.container.size))


def beside(candidate: PlacementCandidate, poses: Mapping[str, Pose]) -> PlacementCandidate:
    """The candidate leaning towards its obstacles, without a rehearsal."""
    return replace(candidate, over=side_of(candidate.X_WN, candidate.collisions, poses))


def _turned(over: Array, angle: float) -> Array:
    """The horizontal vector `(2,)`, turned by an angle [rad]."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s], [s, c]]) @ over
