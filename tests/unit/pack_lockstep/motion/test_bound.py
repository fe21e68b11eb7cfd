from __future__ import annotations

import numpy as np
import pytest

from pack_core.motion.moves import JointMove, Line, Path
from pack_core.rotations import Pose
from pack_motion.arm.arm import load_arm
from pack_motion.reference.path_planner import PathPlanner
from pack_motion.reference.trajectory import JointState

pytest.importorskip("toppra")
from pack_lockstep.motion.bound import least_duration

ARM, SHARE = load_arm("palletizing"), 0.98
START = JointState.at_rest(ARM.home)


@pytest.mark.parametrize(("way", "speed"), [(1.2, 1.0), (1.2, 0.2)])
def test_a_single_joint_takes_as_long_as_a_trapezoid_or_triangle_of_speed(way: float, speed: float) -> None:
    goal = ARM.home + np.array([way, 0.0, 0.0, 0.0, 0.0, 0.0])
    plan = PathPlanner(ARM, SHARE).plan(START, Path((JointMove(goal, speed),)))
    a = SHARE * ARM.limits.acceleration[0]
    v = min(speed * SHARE * ARM.limits.velocity[0], np.sqrt(way * a))
    assert least_duration(ARM, plan, SHARE) == pytest.approx(way / v + v / a, rel=1e-3)


def test_a_line_takes_as_long_as_its_tool_may_be_fast() -> None:
    down = ARM.chain.forward(ARM.home)
    plan = PathPlanner(ARM, SHARE).plan(
        START, Path((Line(Pose(down.p + np.array([0.0, 0.0, 0.3]), down.q), 0.2, 1.0),))
    )
    bound = least_duration(ARM, plan, SHARE)
    assert bound is not None
    assert bound == pytest.approx(0.3 / 0.2 + 0.2 / 1.0, rel=0.02)
    assert bound < plan.trajectory.duration


def test_no_plan_is_faster_than_its_bound() -> None:
    rng = np.random.default_rng(0)
    for _ in range(5):
        goal = ARM.home + rng.uniform(-0.5, 0.5, 6)
        plan = PathPlanner(ARM, SHARE).plan(START, Path((JointMove(goal),)))
        bound = least_duration(ARM, plan, SHARE)
        assert bound is not None
        assert 0.8 * plan.trajectory.duration < bound < plan.trajectory.duration
