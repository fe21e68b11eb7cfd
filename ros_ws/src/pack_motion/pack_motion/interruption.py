"""What remains of a move that was interrupted because the arm's driver held the arm."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from pack_core.motion.moves import UP, JointMove, Line, Path
from pack_core.motion.target import MotionState, MotionTarget
from pack_core.rotations import Array, Pose
from pack_motion.reference.path_planner import MotionPlan
from pack_motion.reference.trajectory import ReferenceTrajectory

UNFINISHED = (MotionState.MOVING, MotionState.SETTLING)
"""States of a move that is not finished."""
SHORT = 1e-6
"""Duration of a reference that stands still [s]; rows need rising times."""
RISES = (0.1, 0.2, 0.3, 0.5, 0.7)
"""Heights by which the tool is raised first, where the move cannot continue from its present pose [m]."""


def left_of(target: MotionTarget, plan: MotionPlan, segment: int, state: MotionState) -> MotionTarget | None:
    """A target with the segments of a plan from the running one on; None where the move is finished.

    A line begins at the present tool pose now and is not quite the planned one, so that the corner after it
    is not rounded.
    """
    if state not in UNFINISHED or target.move == Path(()):
        return None
    first, *others = plan.segments[segment:]
    if isinstance(first, Line):
        first = replace(first, blend=0.0)
    return replace(target, move=Path((first, *others)))


def rising(target: MotionTarget, X_WT: Pose) -> tuple[MotionTarget, ...]:
    """The rest of a move after a straight rise from X_WT, for each height of `RISES`.

    They are tried where the arm came to rest too low to continue at once; a line needs none.
    """
    assert isinstance(target.move, Path)
    first = target.move.segments[0]
    if isinstance(first, Line):
        return ()
    rises = [Line(Pose(X_WT.p + height * UP, X_WT.q), exit_speed=0.25, label=first.label) for height in RISES]
    return tuple(replace(target, move=Path((rise, *target.move.segments))) for rise in rises)


def standing_plan(q: Array, interrupted: MotionPlan, segment: int) -> MotionPlan:
    """A plan that stands at `q` `(n,)` [rad], with the goal and the running label of another plan."""
    rest = np.zeros((2, len(q)))
    trajectory = ReferenceTrajectory(
        np.array([0.0, SHORT]), rest + q, rest, rest, np.zeros(2, dtype=np.int64)
    )
    label = interrupted.segments[segment].label
    return MotionPlan(trajectory, (JointMove(q, label=label),), interrupted.X_WT)
