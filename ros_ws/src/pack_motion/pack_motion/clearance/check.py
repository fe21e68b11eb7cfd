"""Checks a planned move against all standing obstacles, and the arm against itself, before it starts."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from pack_core.motion.moves import Line
from pack_core.motion.world import CarriedBox, Obstacle
from pack_core.rotations import Array, to_matrix
from pack_motion.arm.arm import MotionArm
from pack_motion.arm.bodies import BodyBoxes
from pack_motion.clearance.separation import gaps_along, own_gaps_along
from pack_motion.reference.path_planner import MotionPlan


@dataclass(frozen=True)
class Conflict:
    """A violation of the clearance in a plan.

    Attributes:
        body: name of the arm's body, or of the carried object.
        obstacle: name of the obstacle.
        gap: distance between them [m]; negative where they overlap.
        time: time after the start of the move [s].
        segment: index of the segment of the path.
        text: all of this as an error text.
    """

    body: str
    obstacle: str
    gap: float
    time: float
    segment: int
    text: str


def conflict_at(
    arm: MotionArm, plan: MotionPlan, row: int, body: str, obstacle: str, gap: float, needed: float
) -> Conflict:
    """Describe the conflict at a row of the plan's trajectory; `gap` and `needed` are in metres."""
    trajectory = plan.trajectory
    time, segment = float(trajectory.times[row]), int(trajectory.segment[row])
    p = arm.chain.forward(trajectory.q[row]).p
    how = f"{1000 * gap:.0f} mm from" if gap > 0.0 else f"{-1000 * gap:.0f} mm inside"
    text = (
        f"'{body}' would be {how} '{obstacle}' in '{plan.segments[segment].label}', {time:.2f} s "
        f"after the start, the tool at {p.round(3).tolist()} m; needed: {1000 * max(needed, 0.0):.0f} mm"
    )
    return Conflict(body, obstacle, gap, time, segment, text)


APART = 2
"""Links at least this many places apart along the arm are checked; neighbours touch at their common joint.

The base counts as the first link, which turns on it and carries the shoulder past it.
"""


class OwnBodyCheck:
    """Computes the gaps between the arm's own bodies along a plan, with its closed fingers and its base.

    Where two bodies are nearer than the clearance at the start of a move, they may not come still nearer.

    Args:
        arm: the arm that moves; one without a base is not checked.
        clearance: smallest allowed gap between two bodies [m].
    """

    def __init__(self, arm: MotionArm, clearance: float) -> None:
        self._arm, self._clearance = arm, clearance
        self._bodies, self._pairs = arm.bodies_at(0.0), np.zeros((0, 2), dtype=np.int64)
        if arm.base is not None:
            self._bodies = self._bodies.joined(arm.base)
            link = np.maximum(self._bodies.link, 0)  # the base has link -1
            # The upper triangle, so that each pair is listed once.
            self._pairs = np.argwhere(np.triu(np.abs(link[:, None] - link) >= APART))

    def conflict(self, plan: MotionPlan, rows: npt.NDArray[np.int64]) -> Conflict | None:
        """The largest violation of the clearance at some rows of a plan's trajectory, or None."""
        if len(self._pairs) == 0:
            return None
        gaps = self._gaps(plan.trajectory.q[rows])
        needed = np.minimum(self._clearance, gaps[0])
        t, k = (int(i) for i in np.unravel_index(np.argmax(needed - gaps), gaps.shape))
        if gaps[t, k] >= needed[k]:
            return None
        one, other = (self._bodies.names[i] for i in self._pairs[k])
        return conflict_at(self._arm, plan, int(rows[t]), one, other, float(gaps[t, k]), float(needed[k]))

    def is_clear(self, q: Array) -> bool:
        """Whether joint positions `(T, n)` keep the clearance."""
        return len(self._pairs) == 0 or bool(self._gaps(q).min() >= self._clearance)

    def _gaps(self, q: Array) -> Array:
        chain, b = self._arm.chain, self._bodies
        return np.asarray(own_gaps_along(
            chain.axes, chain.points, np.ascontiguousarray(q), b.link, b.R, b.p, b.half, self._pairs,
            self._clearance,
        ))  # fmt: skip


PERIOD = 0.02
"""Time between the rows of a plan that are checked [s]."""
SLACK = 0.0005
"""On a move's first and last lines a gap may be smaller than at that end by this [m]."""
CARRIED = "carried object"


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

    def gate(self, around: Surrounding, margin: float) -> Callable[[Array], bool]:
        """What says whether joint positions `(T, n)` keep a margin [m] from all that stands.

        And whether the arm keeps the clearance from itself.
        """
        standing = [item for item in around.obstacles if not item.is_moving]
        bodies = with_carried(self._arm, around)
        boxes = box_arrays(standing)

        def is_clear(q: Array) -> bool:
            if standing and self._gaps(q, bodies, boxes, margin).min() < margin:
                return False
            return self._own_body.is_clear(q)

        return is_clear

    def _among(self, plan: MotionPlan, rows: npt.NDArray[np.int64], around: Surrounding) -> Conflict | None:
        standing = [item for item in around.obstacles if not item.is_moving]
        if not standing:
            return None
        bodies, boxes, q = with_carried(self._arm, around), box_arrays(standing), plan.trajectory.q
        enough = 2.0 * self._clearance  # gaps are exact up to there, and cut off
        gaps = self._gaps(q[rows], bodies, boxes, enough)
        between = _between(plan, rows, gaps.min(axis=(1, 2)) < enough)
        if len(between):
            gaps = np.concatenate([gaps, self._gaps(q[between], bodies, boxes, enough)])
            order = np.argsort(rows := np.concatenate([rows, between]))
            rows, gaps = rows[order], gaps[order]
        shortage = self._needed(plan, rows, gaps, standing, around.contacts) - gaps
        t, i, j = (int(k) for k in np.unravel_index(np.argmax(shortage), shortage.shape))
        if shortage[t, i, j] <= 0.0:
            return None
        gap, needed = float(gaps[t, i, j]), float(shortage[t, i, j] + gaps[t, i, j])
        return conflict_at(self._arm, plan, int(rows[t]), bodies.names[i], standing[j].name, gap, needed)

    def _gaps(self, q: Array, bodies: BodyBoxes, boxes: tuple[Array, Array, Array], enough: float) -> Array:
        chain = self._arm.chain
        return np.asarray(gaps_along(
            chain.axes, chain.points, np.ascontiguousarray(q), bodies.link, bodies.R, bodies.p, bodies.half,
            *boxes, enough,
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


def box_arrays(obstacles: Sequence[Obstacle]) -> tuple[Array, Array, Array]:
    """Orientations `(m, 3, 3)`, centres `(m, 3)` and half edge lengths `(m, 3)` [m] of obstacles."""
    R = np.array([to_matrix(item.X_WO.q) for item in obstacles])
    p = np.array([item.X_WO.p for item in obstacles])
    return R, p, np.array([0.5 * item.size for item in obstacles])


def _moments(times: Array) -> npt.NDArray[np.int64]:
    """Indices of rows at most `PERIOD` and one row apart, both ends included."""
    wanted = np.arange(0.0, times[-1], PERIOD)
    rows = np.searchsorted(times, wanted, side="left")
    return np.unique(np.append(rows, len(times) - 1)).astype(np.int64)


def _between(
    plan: MotionPlan, rows: npt.NDArray[np.int64], are_near: npt.NDArray[np.bool_]
) -> npt.NDArray[np.int64]:
    """Indices of the rows before and after those that are near something, up to the next checked ones.

    Between the lines at both ends only: there the tool is so fast that in `PERIOD` it passes an edge, whose
    gap is then twice the clearance before and after it, at a few millimetres.
    """
    first, last = _end_lines(plan)
    segment = plan.trajectory.segment[rows]
    near = np.flatnonzero(are_near & (segment > first) & (segment < last))
    steps = {k for row in near for k in (row - 1, row) if 0 <= k < len(rows) - 1}
    found = [np.arange(rows[k] + 1, rows[k + 1]) for k in sorted(steps)]
    return np.concatenate(found) if found else np.zeros(0, dtype=np.int64)


def _end_lines(plan: MotionPlan) -> tuple[int, int]:
    """The last segment of the lines that a path starts with, and the first of those it ends with."""
    are_lines = [isinstance(segment, Line) for segment in plan.segments]
    first = next((i for i, is_line in enumerate(are_lines) if not is_line), len(are_lines)) - 1
    last = len(are_lines) - next(
        (i for i, is_line in enumerate(reversed(are_lines)) if not is_line), len(are_lines)
    )
    return first, last
