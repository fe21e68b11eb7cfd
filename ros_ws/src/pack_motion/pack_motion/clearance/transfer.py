"""Searches the lengths of a transfer's first and last straight line for which it is clear of obstacles."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from pack_core.motion.moves import (
    DEPART,
    DESCEND,
    RISE,
    TRANSIT,
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
from pack_motion.clearance.check import ClearanceCheck, Surrounding
from pack_motion.reference.path_planner import MotionPlan, PathPlanner
from pack_motion.reference.trajectory import JointState, MoveRefused

STEP = 0.08
"""Largest step between two lengths that are tried [m]."""


class TransferPlanner:
    """Plans transfers that are clear of all obstacles."""

    def __init__(self, arm: MotionArm, paths: PathPlanner, check: ClearanceCheck) -> None:
        self._arm, self._paths, self._check = arm, paths, check

    def plan(self, start: JointState, transfer: Transfer, around: Surrounding) -> MotionPlan:
        """The first clear plan, trying lines from the shortest to the longest.

        If the joint move between the lines is not clear in its first half, the first line is made longer,
        otherwise the last one; where that line has its full length already, the other one grows.

        Raises:
            MoveRefused: no plan is clear; the text names the conflict of the last one that was tried.
        """
        depart = _lengths(transfer.depart) if transfer.depart else np.zeros(1)
        hover = _lengths(transfer.hover)
        i = j = 0
        best_refusal = ""
        while True:
            try:
                plan = self._paths.plan(start, self._path(start, transfer, depart[i], hover[j]))
            except MoveRefused as refusal:
                raise MoveRefused(best_refusal or str(refusal)) from refusal
            conflict = self._check.conflict(plan, around)
            if conflict is None:
                return plan
            best_refusal = conflict.text
            if plan.segments[conflict.segment].label != TRANSIT:  # longer lines cannot help the lines
                raise MoveRefused(conflict.text)
            is_early = conflict.time < _middle(plan)
            can_lift, can_hover = i + 1 < len(depart), j + 1 < len(hover)
            if can_lift and (is_early or not can_hover):
                i += 1
            elif can_hover:
                j += 1
            else:
                raise MoveRefused(conflict.text)

    def _path(self, start: JointState, transfer: Transfer, depart: float, hover: float) -> Path:
        first = transfer.lines[0]
        X_hover = _shifted(first.X_WT, transfer.hover, hover)
        segments: list[Segment] = []
        if transfer.depart is not None:
            segments += _departing(self._arm.chain.forward(start.q), transfer.depart, depart)
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
