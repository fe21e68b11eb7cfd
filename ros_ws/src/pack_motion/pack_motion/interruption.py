"""What remains of a move when the arm's driver held it in between."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from pack_core.motion.moves import JointMove, Path
from pack_core.motion.target import MotionState, MotionTarget
from pack_core.rotations import Array
from pack_motion.reference.path_planner import Plan
from pack_motion.reference.trajectory import Trajectory

UNFINISHED = (MotionState.MOVING, MotionState.SETTLING)
"""States in which something of a move is left."""
SHORT = 1e-6
"""Duration of a reference that stands [s]."""


def left_of(target: MotionTarget, plan: Plan, segment: int, state: MotionState) -> MotionTarget | None:
    """The segments of a plan from the running one on, under the target's number; None where none is left."""
    if state not in UNFINISHED or target.move == Path(()):
        return None
    return replace(target, move=Path(plan.segments[segment:]))


def standing_plan(q: Array, interrupted: Plan, segment: int) -> Plan:
    """Stand at `q` `(n,)` [rad] in the middle of another plan: its goal and the running label stay."""
    rest = np.zeros((2, len(q)))
    trajectory = Trajectory(np.array([0.0, SHORT]), rest + q, rest, rest, np.zeros(2, dtype=np.int64))
    label = interrupted.segments[segment].label
    return Plan(trajectory, (JointMove(q, label=label),), interrupted.X_WT)
