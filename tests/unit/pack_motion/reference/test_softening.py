"""A line that asks a joint for too much acceleration loses acceleration there, and no speed elsewhere."""

from __future__ import annotations

import numpy as np

from pack_core.motion.moves import Line, Path, PoseMove
from pack_motion.arm.arm import MotionArm
from pack_motion.reference.path_planner import PathPlanner
from pack_motion.reference.trajectory import JointState
from unit.pack_motion.loop import SHARE, pose

ABOVE, ON = pose(-2.5, 2.5, 1.3, 0.1), pose(-2.5, 2.5, 0.9, 0.1)


def test_it_still_reaches_its_speed_and_keeps_every_limit(arm: MotionArm) -> None:
    paths = PathPlanner(arm, SHARE)
    above = paths.plan(JointState.at_rest(arm.home), Path((PoseMove(ABOVE),))).trajectory.end
    plan = paths.plan(above, Path((Line(ON, speed=0.25, acceleration=6.0),)))
    rows = plan.trajectory
    speeds = [
        float(np.linalg.norm((arm.chain.jacobian(q) @ v)[:3])) for q, v in zip(rows.q, rows.v, strict=True)
    ]
    assert max(speeds) > 0.249
    assert (np.abs(rows.a) / arm.limits.acceleration).max() <= SHARE + 1e-6
    assert (np.abs(rows.v) / arm.limits.velocity).max() <= SHARE + 1e-6
