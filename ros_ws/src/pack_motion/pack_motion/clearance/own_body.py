"""Checks a planned move of an arm against the arm itself."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from pack_motion.arm.arm import MotionArm
from pack_motion.clearance.conflict import Conflict, conflict_at
from pack_motion.clearance.separation import own_gaps_along
from pack_motion.reference.path_planner import MotionPlan

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
        chain, b = self._arm.chain, self._bodies
        gaps = own_gaps_along(
            chain.axes, chain.points, np.ascontiguousarray(plan.trajectory.q[rows]), b.link, b.R, b.p, b.half,
            self._pairs, self._clearance,
        )  # fmt: skip
        needed = np.minimum(self._clearance, gaps[0])
        t, k = (int(i) for i in np.unravel_index(np.argmax(needed - gaps), gaps.shape))
        if gaps[t, k] >= needed[k]:
            return None
        one, other = (b.names[i] for i in self._pairs[k])
        return conflict_at(self._arm, plan, int(rows[t]), one, other, float(gaps[t, k]), float(needed[k]))
