"""Checks a planned move against everything that stands around, before it starts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from pack_core.motion.moves import Line
from pack_core.motion.world import CarriedBox, Obstacle
from pack_core.rotations import Array, to_matrix
from pack_motion.arm.arm import Arm
from pack_motion.arm.body_boxes import BodyBoxes
from pack_motion.clearance.separation import gaps_along
from pack_motion.reference.path_planner import Plan

PERIOD = 0.02
"""Between the moments that are looked at [s]."""
SLACK = 0.0005
"""What a gap near the ends of a move may shrink by on the way [m]."""
CARRIED = "carried box"


@dataclass(frozen=True)
class Surrounding:
    """What a move is made among.

    Attributes:
        obstacles: what stands around.
        carried: the box in the hand.
        contacts: names of obstacles that may be touched where the move starts and ends.
    """

    obstacles: tuple[Obstacle, ...] = ()
    carried: CarriedBox | None = None
    contacts: frozenset[str] = frozenset()


@dataclass(frozen=True)
class Conflict:
    """What comes too near to what.

    Attributes:
        body: of the arm, or the carried box.
        obstacle: its name.
        gap: between them [m]; negative where they overlap.
        needed: gap that would do [m].
        time: after the start of the move [s].
        segment: of the path.
        text: all that in words.
    """

    body: str
    obstacle: str
    gap: float
    needed: float
    time: float
    segment: int
    text: str


class ClearanceCheck:
    """Looks along a plan at every body of the arm and every obstacle.

    Between its ends a move keeps the whole clearance. On the lines that it starts and ends with, a pair
    may be as near as it is at that end; only `contacts` may touch there.
    """

    def __init__(self, arm: Arm, clearance: float) -> None:
        self._arm, self._clearance = arm, clearance

    def conflict(self, plan: Plan, around: Surrounding) -> Conflict | None:
        """The worst shortage of room, or None where there is none."""
        standing = [item for item in around.obstacles if not item.is_moving]
        if not standing:
            return None
        bodies = with_carried(self._arm, around.carried)
        rows = _moments(plan.trajectory.times)
        gaps = self._gaps(plan.trajectory.q[rows], bodies, standing)
        shortage = self._needed(plan, rows, gaps, standing, around.contacts) - gaps
        t, i, j = (int(k) for k in np.unravel_index(np.argmax(shortage), shortage.shape))
        if shortage[t, i, j] <= 0.0:
            return None
        gap, needed = float(gaps[t, i, j]), float(shortage[t, i, j] + gaps[t, i, j])
        return self._conflict(plan, int(rows[t]), bodies.names[i], standing[j].name, gap, needed)

    def _gaps(self, q: Array, bodies: BodyBoxes, standing: Sequence[Obstacle]) -> Array:
        R = np.array([to_matrix(item.X_WO.q) for item in standing])
        p = np.array([item.X_WO.p for item in standing])
        half = np.array([0.5 * item.size for item in standing])
        chain = self._arm.chain
        return np.asarray(gaps_along(
            chain.axes, chain.points, np.ascontiguousarray(q), bodies.link, bodies.R, bodies.p, bodies.half,
            R, p, half, 2.0 * self._clearance,
        ))  # fmt: skip

    def _needed(
        self, plan: Plan, rows: npt.NDArray[np.int64], gaps: Array, standing: Sequence[Obstacle],
        contacts: frozenset[str],
    ) -> Array:  # fmt: skip
        """Gaps that are needed `(T, k, m)`."""
        least = np.array([-np.inf if item.name in contacts else SLACK for item in standing])
        at_start, at_end = (np.maximum(gaps[t] - SLACK, least) for t in (0, -1))
        first, last = _end_lines(plan)
        segment = plan.trajectory.segment[rows]
        needed = np.full(gaps.shape, self._clearance)
        near_start, near_end = segment <= first, segment >= last
        needed[near_start] = np.minimum(needed[near_start], at_start)
        needed[near_end] = np.minimum(needed[near_end], at_end)
        return needed

    def _conflict(
        self, plan: Plan, row: int, body: str, obstacle: str, gap: float, needed: float
    ) -> Conflict:
        trajectory = plan.trajectory
        time, segment = float(trajectory.times[row]), int(trajectory.segment[row])
        p = self._arm.chain.forward(trajectory.q[row]).p
        how = f"{1000 * gap:.0f} mm from" if gap > 0.0 else f"{-1000 * gap:.0f} mm inside"
        text = (
            f"'{body}' would be {how} '{obstacle}' in '{plan.segments[segment].label}', {time:.2f} s "
            f"after the start, the tool at {p.round(3).tolist()} m; needed: {1000 * max(needed, 0.0):.0f} mm"
        )
        return Conflict(body, obstacle, gap, needed, time, segment, text)


def with_carried(arm: Arm, carried: CarriedBox | None) -> BodyBoxes:
    """The arm's boxes, and the one in its hand."""
    bodies, chain = arm.bodies, arm.chain
    if carried is None:
        return bodies
    R = chain.R_WT @ to_matrix(carried.X_TB.q)
    p = chain.p_WT + chain.R_WT @ carried.X_TB.p
    return BodyBoxes(
        (*bodies.names, CARRIED), np.append(bodies.link, chain.n - 1), np.concatenate([bodies.R, R[None]]),
        np.vstack([bodies.p, p]), np.vstack([bodies.half, 0.5 * carried.size]),
    )  # fmt: skip


def _moments(times: Array) -> npt.NDArray[np.int64]:
    """Rows at most `PERIOD` and a row apart, both ends included."""
    wanted = np.arange(0.0, times[-1], PERIOD)
    rows = np.searchsorted(times, wanted, side="left")
    return np.unique(np.append(rows, len(times) - 1)).astype(np.int64)


def _end_lines(plan: Plan) -> tuple[int, int]:
    """The last segment of the lines that a path starts with, and the first of those it ends with."""
    are_lines = [isinstance(segment, Line) for segment in plan.segments]
    first = next((i for i, is_line in enumerate(are_lines) if not is_line), len(are_lines)) - 1
    last = len(are_lines) - next(
        (i for i, is_line in enumerate(reversed(are_lines)) if not is_line), len(are_lines)
    )
    return first, last
