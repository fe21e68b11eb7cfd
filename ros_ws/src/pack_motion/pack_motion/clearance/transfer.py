"""Searches the lengths of a transfer's first and last straight line for which it is clear of obstacles.

Where no lengths are, it goes around: see `pack_motion.clearance.detour`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Protocol

import numpy as np

from pack_core.motion.moves import (
    DEPART,
    DESCEND,
    RISE,
    TRANSIT,
    JointMove,
    Line,
    Mode,
    Path,
    PoseMove,
    Retreat,
    Segment,
    Transfer,
)
from pack_core.rotations import Array, Pose
from pack_motion.arm.arm import MotionArm
from pack_motion.clearance.check import ClearanceCheck, Conflict, Surrounding
from pack_motion.clearance.detour import DetourSearch
from pack_motion.reference.path_planner import MotionPlan, PathPlanner
from pack_motion.reference.trajectory import JointState, MoveRefused

STEP = 0.08
"""Largest step between two lengths that are tried [m]."""


MARGINS = (0.1, 0.05, 0.02)
"""Gaps that ways around keep from everything [m], tried in turn: the reference does not follow their edges
exactly."""
GOALS = 3
"""Postures over the place that ways are searched to, for each margin."""
SEED = 0
"""Of the poses that ways around are drawn from: the same request has the same plan."""


class WaySearch(Protocol):
    """Searches a way between joint positions."""

    def way(self, q_start: Array, q_end: Array) -> list[Array] | None:
        """Joint positions from `q_start` to `q_end` with clear straight edges between them, or None."""


class TransferPlanner:
    """Plans transfers that are clear of all obstacles.

    Args:
        arm: the arm that moves.
        paths: plans a reference through given segments.
        check: whether a reference is clear.
        search: makes what searches ways around, of the arm, of what says whether joint positions `(T, n)`
            are clear, and of a random generator.
    """

    def __init__(
        self,
        arm: MotionArm,
        paths: PathPlanner,
        check: ClearanceCheck,
        search: Callable[[MotionArm, Callable[[Array], bool], np.random.Generator], WaySearch] = DetourSearch,
    ) -> None:
        self._arm, self._paths, self._check, self._search = arm, paths, check, search

    def plan(self, start: JointState, transfer: Transfer, around: Surrounding) -> MotionPlan:
        """The first clear plan: lines from the shortest to the longest, then ways around.

        Raises:
            MoveRefused: no plan is clear; the text names the conflict of the last lengths that were tried.
        """
        found = self.by_height(start, transfer, around)
        if isinstance(found, MotionPlan):
            return found
        plan = self.detoured(start, transfer, around)
        if plan is None:
            raise MoveRefused(found.text)
        return plan

    def by_height(self, start: JointState, transfer: Transfer, around: Surrounding) -> MotionPlan | Conflict:
        """The first clear plan straight over everything, or the conflict that no length of the lines solves.

        If the joint move between the lines is not clear in its first half, the first line is made longer,
        otherwise the last one; where that line has its full length already, the other one grows.

        Raises:
            MoveRefused: the lines themselves are not clear, or out of reach.
        """
        depart, hover = _departures(transfer), _lengths(transfer.hover)
        i = j = 0
        conflict: Conflict | None = None
        while True:
            try:
                plan = self._paths.plan(start, self._path(start, transfer, depart[i], hover[j]))
            except MoveRefused:
                if conflict is None:
                    raise
                return conflict
            conflict = self._check.conflict(plan, around)
            if conflict is None:
                return plan
            if plan.segments[conflict.segment].label != TRANSIT:  # longer lines cannot help the lines
                raise MoveRefused(conflict.text)
            is_early = conflict.time < _middle(plan)
            can_lift, can_hover = i + 1 < len(depart), j + 1 < len(hover)
            if can_lift and (is_early or not can_hover):
                i += 1
            elif can_hover:
                j += 1
            else:
                return conflict

    def detoured(self, start: JointState, transfer: Transfer, around: Surrounding) -> MotionPlan | None:
        """A clear plan around what stands in the way; None where none is found."""
        rng = np.random.default_rng(SEED)
        for margin in MARGINS:
            is_clear = self._check.gate(around, margin)
            depart, q_from = self._departed(start, transfer, is_clear)
            if q_from is None:
                continue
            for hover, q_to in self._hovering(q_from, transfer, is_clear)[:GOALS]:
                way = self._search(self._arm, is_clear, rng).way(q_from, q_to)
                if way is None:
                    continue
                try:
                    plan = self._paths.plan(start, self._path(start, transfer, depart, hover, way[1:]))
                except MoveRefused:
                    continue
                if self._check.conflict(plan, around) is None:
                    return plan
        return None

    def _departed(
        self, start: JointState, transfer: Transfer, is_clear: Callable[[Array], bool]
    ) -> tuple[float, Array | None]:
        """The shortest first line at whose end the arm is clear, and the joint positions there."""
        if transfer.depart is None:
            return 0.0, start.q if is_clear(start.q[None]) else None
        X_WT, branch = self._arm.chain.forward(start.q), self._arm.inverse.branch(start.q)
        for length in _lengths(transfer.depart):
            q = self._arm.inverse.follow(_shifted(X_WT, transfer.depart, length), start.q, branch)
            if q is not None and is_clear(q[None]):
                return float(length), q
        return 0.0, None

    def _hovering(
        self, q_from: Array, transfer: Transfer, is_clear: Callable[[Array], bool]
    ) -> list[tuple[float, Array]]:
        """Lengths of the last line and joint positions over it where the arm is clear, nearest first.

        Of every flip of the wrist and turn of a joint, the shortest line.
        """
        arm = self._arm
        shoulder, elbow, _ = arm.inverse.branch(q_from)
        found: dict[tuple[int, ...], tuple[float, Array]] = {}
        for length in _lengths(transfer.hover):
            X_hover = _shifted(transfer.lines[0].X_WT, transfer.hover, length)
            for q in arm.inverse.candidates(X_hover, shoulder, elbow):
                kind = (arm.inverse.branch(q)[2], *(int(turn) for turn in np.floor(q / np.pi)))
                if kind not in found and is_clear(q[None]):
                    found[kind] = float(length), q
        velocity = arm.limits.velocity
        return sorted(found.values(), key=lambda end: float((np.abs(end[1] - q_from) / velocity).max()))

    def _path(
        self, start: JointState, transfer: Transfer, depart: float, hover: float, way: Sequence[Array] = ()
    ) -> Path:
        """The segments for these lengths; a way of joint positions, if given, ends at the hover pose."""
        first = transfer.lines[0]
        X_hover = _shifted(first.X_WT, transfer.hover, hover)
        segments: list[Segment] = []
        if transfer.depart is not None:
            segments += _departing(self._arm.chain.forward(start.q), transfer.depart, depart)
        if way:
            segments += [JointMove(q, transfer.speed, transfer.acceleration, label=TRANSIT) for q in way]
        else:
            segments.append(PoseMove(X_hover, transfer.speed, transfer.acceleration, label=TRANSIT))
        return Path((*segments, *_approaching(first, transfer.hover, hover), *transfer.lines[1:]))


def _departing(X_WT: Pose, out: Retreat, length: float) -> list[Line]:
    """The line away from `X_WT`: its slow segment first, where there is one, then the rest."""
    rest = Line(
        _shifted(X_WT, out, length), out.speed, out.acceleration, exit_speed=out.pass_speed, label=DEPART
    )
    if not out.slow_length:
        return [rest]
    slow = replace(rest, speed=min(out.speed, out.slow_speed))
    if length <= out.slow_length:
        return [slow]
    near = replace(slow, X_WT=_shifted(X_WT, out, out.slow_length), exit_speed=slow.speed)
    return [near, replace(rest, label=RISE, mode=Mode.FAST)]


def _approaching(first: Line, hover: Retreat, length: float) -> list[Line]:
    """The line in to a transfer's own first line: fast from the hover pose, then slow near its end."""
    if not hover.slow_length:
        return [replace(first, entry_speed=hover.pass_speed)]
    slow = replace(first, speed=min(first.speed, hover.slow_speed), entry_speed=hover.pass_speed)
    if length <= hover.slow_length:
        return [slow]
    X_near = _shifted(first.X_WT, hover, hover.slow_length)
    fast = Line(
        X_near, first.speed, first.acceleration, entry_speed=hover.pass_speed, exit_speed=slow.speed,
        label=DESCEND, mode=Mode.FAST,
    )  # fmt: skip
    return [fast, slow]


def _departures(transfer: Transfer) -> Array:
    return _lengths(transfer.depart) if transfer.depart else np.zeros(1)


def _lengths(retreat: Retreat) -> Array:
    shortest, longest = retreat.lengths
    n = max(int(np.ceil((longest - shortest) / STEP - 1e-9)), 0) + 1
    return np.linspace(shortest, longest, n)


def _shifted(X: Pose, retreat: Retreat, length: float) -> Pose:
    direction = np.asarray(retreat.direction, dtype=float)
    return Pose(X.p + length * direction / np.linalg.norm(direction), X.q)


def _middle(plan: MotionPlan) -> float:
    """Time of the middle of the joint move between the lines [s]."""
    labels = [segment.label for segment in plan.segments]
    times = plan.trajectory.times[plan.trajectory.segment == labels.index(TRANSIT)]
    return float(0.5 * (times[0] + times[-1]))
