"""Checks a planned move against all standing obstacles before it starts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from pack_core.motion.moves import Line
from pack_core.motion.world import CarriedBox, Obstacle
from pack_core.rotations import Array, to_matrix
from pack_motion.arm.arm import MotionArm
from pack_motion.arm.body_boxes import BodyBoxes
from pack_motion.clearance.conflict import Conflict, conflict_at
from pack_motion.clearance.own_body import OwnBodyCheck
from pack_motion.clearance.separation import gaps_along
from pack_motion.reference.path_planner import MotionPlan

PERIOD = 0.02
"""Time between the rows of a plan that are checked [s]."""
SLACK = 0.0005
"""On a move's first and last lines a gap may be smaller than at that end by this [m]."""
CARRIED = "carried box"


@dataclass(frozen=True)
class Surrounding:
    """Everything besides the plan that decides whether a move is clear.

    Attributes:
        obstacles: the obstacles in the cell; moving ones are left out of the check.
        carried: the box in the gripper.
        contacts: names of obstacles that may be touched where the move starts and ends.
        opening: distance between the fingers of a gripper that has them [m].
    """

    obstacles: tuple[Obstacle, ...] = ()
    carried: CarriedBox | None = None
    contacts: frozenset[str] = frozenset()
    opening: float = 0.0


class ClearanceCheck:
    """Computes the gap between every body of the arm and every obstacle along a plan.

    Between its ends a move keeps the whole clearance. On the lines that it starts and ends with, a body and
    an obstacle may be as near to each other as they are at that end; only `contacts` may be touched there.
    """

    def __init__(self, arm: MotionArm, clearance: float) -> None:
        self._arm, self._clearance = arm, clearance
        self._own_body = OwnBodyCheck(arm, clearance)

    def conflict(self, plan: MotionPlan, around: Surrounding) -> Conflict | None:
        """The largest violation of the clearance, or None where there is none."""
        rows = _moments(plan.trajectory.times)
        return self._among(plan, rows, around) or self._own_body.conflict(plan, rows)

    def _among(self, plan: MotionPlan, rows: npt.NDArray[np.int64], around: Surrounding) -> Conflict | None:
        standing = [item for item in around.obstacles if not item.is_moving]
        if not standing:
            return None
        bodies = with_carried(self._arm, around)
        gaps = self._gaps(plan.trajectory.q[rows], bodies, standing)
        shortage = self._needed(plan, rows, gaps, standing, around.contacts) - gaps
        t, i, j = (int(k) for k in np.unravel_index(np.argmax(shortage), shortage.shape))
        if shortage[t, i, j] <= 0.0:
            return None
        gap, needed = float(gaps[t, i, j]), float(shortage[t, i, j] + gaps[t, i, j])
        return conflict_at(self._arm, plan, int(rows[t]), bodies.names[i], standing[j].name, gap, needed)

    def _gaps(self, q: Array, bodies: BodyBoxes, standing: Sequence[Obstacle]) -> Array:
        R = np.array([to_matrix(item.X_WO.q) for item in standing])
        p = np.array([item.X_WO.p for item in standing])
        half = np.array([0.5 * item.size for item in standing])
        chain = self._arm.chain
        return np.asarray(gaps_along(
            chain.axes, chain.points, np.ascontiguousarray(q), bodies.link, bodies.R, bodies.p, bodies.half,
            R, p, half, 2.0 * self._clearance,  # gaps are exact up to twice what is needed, and cut off there
        ))  # fmt: skip

    def _needed(
        self, plan: MotionPlan, rows: npt.NDArray[np.int64], gaps: Array, standing: Sequence[Obstacle],
        contacts: frozenset[str],
    ) -> Array:  # fmt: skip
        """Smallest allowed gap [m] at T rows, for k bodies of the arm and m obstacles: `(T, k, m)`."""
        least = np.array([-np.inf if item.name in contacts else 0.0 for item in standing])
        at_start, at_end = (np.maximum(gaps[t] - SLACK, least) for t in (0, -1))
        first, last = _end_lines(plan)
        segment = plan.trajectory.segment[rows]
        needed = np.full(gaps.shape, self._clearance)
        near_start, near_end = segment <= first, segment >= last
        needed[near_start] = np.minimum(needed[near_start], at_start)
        needed[near_end] = np.minimum(needed[near_end], at_end)
        return needed


def with_carried(arm: MotionArm, around: Surrounding) -> BodyBoxes:
    """The boxes around the arm's bodies, and the carried box as one more body fixed to the last link."""
    bodies, chain, carried = arm.bodies_at(around.opening), arm.chain, around.carried
    if carried is None:
        return bodies
    # Bodies are given where all joints are zero, and chain.R_WT and p_WT are the tool's pose there.
    R = chain.R_WT @ to_matrix(carried.X_TB.q)
    p = chain.p_WT + chain.R_WT @ carried.X_TB.p
    box = BodyBoxes((CARRIED,), np.array([chain.n - 1]), R[None], p[None], 0.5 * carried.size[None])
    return bodies.joined(box)


def _moments(times: Array) -> npt.NDArray[np.int64]:
    """Indices of rows at most `PERIOD` and one row apart, both ends included."""
    wanted = np.arange(0.0, times[-1], PERIOD)
    rows = np.searchsorted(times, wanted, side="left")
    return np.unique(np.append(rows, len(times) - 1)).astype(np.int64)


def _end_lines(plan: MotionPlan) -> tuple[int, int]:
    """The last segment of the lines that a path starts with, and the first of those it ends with."""
    are_lines = [isinstance(segment, Line) for segment in plan.segments]
    first = next((i for i, is_line in enumerate(are_lines) if not is_line), len(are_lines)) - 1
    last = len(are_lines) - next(
        (i for i, is_line in enumerate(reversed(are_lines)) if not is_line), len(are_lines)
    )
    return first, last
