"""Keeps the protective separation distance: slows the plan down, and stops it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cache

import numpy as np

from pack_core.rotations import Array
from pack_motion.arm.arm import MotionArm
from pack_motion.arm.bodies import BodyBoxes
from pack_motion.reference.trajectory import ReferenceTrajectory
from pack_motion.safety.distances import BoxDistances
from pack_motion.safety.protective_distance import PredictedStop, ProtectiveSeparation, protective_distances
from pack_motion.safety.stop_ahead import rate_bounds, stop_ahead, ways_of_bodies

HALVINGS = 5
"""Halvings of the interval that the next rate may come from: it is found to a thirtieth of it."""


@dataclass(frozen=True)
class Seen:
    """Who is seen around the arm, as boxes `m` in number.

    Attributes:
        names: what reports call them.
        R: orientations `(m, 3, 3)`.
        p: centres when they were seen `(m, 3)` [m].
        half: half edge lengths `(m, 3)` [m].
        speed: `(m,)` [m/s].
        age: time since they were seen [s].
    """

    names: tuple[str, ...] = ()
    R: Array = field(default_factory=lambda: np.zeros((0, 3, 3)))
    p: Array = field(default_factory=lambda: np.zeros((0, 3)))
    half: Array = field(default_factory=lambda: np.zeros((0, 3)))
    speed: Array = field(default_factory=lambda: np.zeros(0))
    age: float = 0.0


NOBODY = Seen()


@dataclass(frozen=True)
class Margin:
    """The smallest margin over all bodies of the arm and all who are seen.

    Attributes:
        value: distance less protective separation distance [m]; infinite while nobody is seen.
        distance: of the two that have it [m].
        body: name of the arm's body, or of the carried object.
        who: name of who is seen.
    """

    value: float = np.inf
    distance: float = np.inf
    body: str = ""
    who: str = ""


class SeparationMonitor:
    """Chooses the rate at which a plan is followed so that every margin stays at or above 0 in motion.

    A stop along the plan is predicted anew in each cycle, from the present rate. The rate rises to the
    highest one, of those that joints can reach within the cycle, from which the arm could still stop before
    anybody comes as near as the standard allows, also when the next observation is about to come. It falls,
    as little as it must, where the arm could not stop if it had to now. Between the two it stays, or it would
    rise after each observation and fall before the next one, as the age of the newest one counts.

    Args:
        config: the terms of the distance that do not depend on the motion.
        arm: the arm.
        bodies: boxes around its links and what it carries.
        time: from standing still to full rate, at least [s].
    """

    def __init__(self, config: ProtectiveSeparation, arm: MotionArm, bodies: BodyBoxes, time: float) -> None:
        self._config, self._chain, self._limit = config, arm.chain, arm.limits.acceleration
        self._bodies, self._time = bodies, time
        self._distances: BoxDistances | None = None
        self.margin = Margin()
        """At the rate of the last cycle."""

    def rate(
        self, h: float, plan: ReferenceTrajectory, clock: float, rates: tuple[float, float, float], q: Array,
        seen: Seen,
    ) -> float:  # fmt: skip
        """The rate of the next cycle.

        Args:
            h: duration of a cycle [s].
            plan: the plan.
            clock: present time of the plan [s].
            rates: the lowest rate that the joints can reach in a cycle, the present one, and the highest one
                that they can reach and that is wished.
            q: commanded joint positions `(n,)` [rad]; away from the plan where the arm makes room.
            seen: who is seen.
        """
        lowest, _, highest = rates
        if not seen.names:
            self.margin = Margin()
            return highest
        b, config = self._bodies, self._config
        gaps = self._distances_from(seen).between(*b.moved(*self._chain.links(q)), seen.R, seen.p)

        @cache
        def stop(rate: float) -> PredictedStop:
            return self._stop(plan, clock, rate, h)

        def margin(rate: float, age: float, speed_reserve: float = 0.0) -> Margin:
            S_p = protective_distances(config, seen.speed + speed_reserve, age, stop(rate))
            i, j = (int(k) for k in np.unravel_index(np.argmin(gaps - S_p), gaps.shape))
            return Margin(float(gaps[i, j] - S_p[i, j]), float(gaps[i, j]), b.names[i], seen.names[j])

        def is_kept(rate: float) -> bool:
            return margin(rate, seen.age, config.speed_reserve).value >= config.reserve

        def is_kept_until_seen_again(rate: float) -> bool:
            oldest = max(seen.age, config.oldest)
            return margin(rate, oldest, config.speed_reserve).value >= config.reserve

        is_blind = seen.age > config.blind
        rate = lowest if is_blind else _chosen(rates, is_kept, is_kept_until_seen_again)
        self.margin = margin(rate, seen.age)
        return rate

    def bounds(self, v: Array, a: Array, rate: float) -> tuple[float, float]:
        """Bounds of the change of the rate [1/s]; see `rate_bounds`."""
        return rate_bounds(v, a, rate, self._limit, self._time)

    def _distances_from(self, seen: Seen) -> BoxDistances:
        """Distances from those who are seen, made anew when others come or one is seen with another size."""
        if self._distances is None or not np.array_equal(self._distances.others, seen.half):
            self._distances = BoxDistances(self._bodies.half, seen.half)
        return self._distances

    def _stop(self, plan: ReferenceTrajectory, clock: float, rate: float, h: float) -> PredictedStop:
        way, braking, stopping = stop_ahead(plan.times, plan.q, plan.v, plan.a, clock, rate, self._limit, h)
        b, chain = self._bodies, self._chain
        ways = ways_of_bodies(chain.axes, chain.points, way, braking, b.link, b.R, b.p, b.half)
        return PredictedStop(stopping, *ways)


def _chosen(
    rates: tuple[float, float, float],
    is_kept: Callable[[float], bool],
    is_kept_until_seen_again: Callable[[float], bool],
) -> float:
    """The next rate, from the lowest, the present and the highest one; see `SeparationMonitor`."""
    lowest, present, highest = rates
    present = min(max(present, lowest), highest)
    if is_kept_until_seen_again(highest):
        return highest
    if is_kept_until_seen_again(present):
        return _highest_of(is_kept_until_seen_again, present, highest)
    if is_kept(present):
        return present
    return _highest_of(is_kept, lowest, present) if is_kept(lowest) else lowest


def _highest_of(is_kept: Callable[[float], bool], rate: float, too_high: float) -> float:
    """The highest rate, from one that is kept to one that is not, to a part of `HALVINGS`."""
    for _ in range(HALVINGS):
        middle = 0.5 * (rate + too_high)
        if is_kept(middle):
            rate = middle
        else:
            too_high = middle
    return rate
