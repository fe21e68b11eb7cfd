"""What remains of a move when the arm's driver held it in between."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from pack_core.motion.moves import UP, JointMove, Line, Path
from pack_core.motion.target import MotionState, MotionTarget
from pack_core.rotations import Array, Pose
from pack_motion.reference.path_planner import MotionPlan
from pack_motion.reference.trajectory import ReferenceTrajectory

UNFINISHED = (MotionState.MOVING, MotionState.SETTLING)
"""States in which something of a move is left."""
SHORT = 1e-6
"""Duration of a reference that stands [s]."""
RISES = (0.1, 0.2, 0.3, 0.5, 0.7)
"""Heights that the tool rises by before it goes on, where it cannot go on at once [m]."""


def left_of(target: MotionTarget, plan: MotionPlan, segment: int, state: MotionState) -> MotionTarget | None:
    """The segments of a plan from the running one on, under the target's number; None where none is left.

    A line that is begun anew is not quite the old one, so that the corner after it is not rounded.
    """
    if state not in UNFINISHED or target.move == Path(()):
        return None
    first, *others = plan.segments[segment:]
    if isinstance(first, Line):
        first = replace(first, blend=0.0)
    return replace(target, move=Path((first, *others)))


def rising(target: MotionTarget, X_WT: Pose) -> tuple[MotionTarget, ...]:
    """What is left of a move, with a rise from X_WT before it: the arm may have come to rest too low."""
    assert isinstance(target.move, Path)
    first = target.move.segments[0]
    if isinstance(first, Line):
        return ()
    rises = [Line(Pose(X_WT.p + height * UP, X_WT.q), exit_speed=0.25, label=first.label) for height in RISES]
    return tuple(replace(target, move=Path((rise, *target.move.segments))) for rise in rises)


def standing_plan(q: Array, interrupted: MotionPlan, segment: int) -> MotionPlan:
    """Stand at `q` `(n,)` [rad] in the middle of another plan: its goal and the running label stay."""
    rest = np.zeros((2, len(q)))
    trajectory = ReferenceTrajectory(
        np.array([0.0, SHORT]), rest + q, rest, rest, np.zeros(2, dtype=np.int64)
    )
    label = interrupted.segments[segment].label
    return MotionPlan(trajectory, (JointMove(q, label=label),), interrupted.X_WT)
