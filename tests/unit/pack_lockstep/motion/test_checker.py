"""The checker finds what is wrong with plans that are wrong by a known amount."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from pack_core.motion.moves import Line, Path, PoseMove
from pack_core.motion.target import MotionTarget
from pack_core.motion.world import CarriedBox, Obstacle
from pack_core.rotations import Array, Pose
from pack_lockstep.motion.checker import PlanChecker, PlanVerdict
from pack_lockstep.motion.requests import MotionRequest
from pack_motion.arm.arm import load_arm
from pack_motion.reference.path_planner import MotionPlan, PathPlanner
from pack_motion.reference.trajectory import JointState

CLEARANCE = 0.012
ARM = load_arm("palletizing")
START, DOWN = JointState.at_rest(ARM.home), ARM.chain.forward(ARM.home)
GOAL = Pose(DOWN.p + np.array([0.0, 0.0, 0.3]), DOWN.q)
HALF = 0.1
BOX = CarriedBox(Pose(np.array([0.0, 0.0, HALF])), np.full(3, 2.0 * HALF))


def planned(*segments: Line | PoseMove) -> MotionPlan:
    return PathPlanner(ARM, 0.98).plan(START, Path(segments))


def verdict(plan: MotionPlan, *obstacles: Obstacle, contacts: frozenset[str] = frozenset()) -> PlanVerdict:
    target = MotionTarget(1, Path(plan.segments), BOX, obstacles, contacts)
    return PlanChecker(ARM, CLEARANCE).check(MotionRequest("", "palletizing", START, target), plan)


def under(gap: float) -> Obstacle:
    """A plate under the carried box where a move starts, so far from its lower face [m]."""
    p = DOWN.p + np.array([0.0, 0.0, -2.0 * HALF - gap - 0.05])
    return Obstacle("plate", Pose(p), np.array([0.1, 0.1, 0.1]))


@pytest.mark.parametrize("gap", [0.005, 0.015])
def test_the_gap_of_a_carried_box_is_what_it_is(gap: float) -> None:
    """The box hangs under the tool and is lifted from over a plate: it is nearest where it starts."""
    found = verdict(planned(PoseMove(GOAL)), under(gap))
    assert found.gap == pytest.approx(gap - CLEARANCE, abs=1e-4)
    assert found.is_ok == (gap > CLEARANCE)


def test_on_its_first_line_a_move_may_be_as_near_as_where_it_starts() -> None:
    assert verdict(planned(Line(GOAL)), under(0.005)).is_ok


def test_only_contacts_may_be_touched() -> None:
    plan = planned(Line(GOAL))
    assert not verdict(plan, under(-0.01)).is_ok
    assert verdict(plan, under(-0.01), contacts=frozenset({"plate"})).is_ok


def changed(plan: MotionPlan, **columns: Array) -> MotionPlan:
    return replace(plan, trajectory=replace(plan.trajectory, **columns))


def test_wrong_ends_and_broken_limits_are_named() -> None:
    plan = planned(PoseMove(GOAL))
    rows = plan.trajectory
    assert verdict(plan).is_ok
    assert "begin" in verdict(changed(plan, q=rows.q + 1e-3)).problem
    bent = rows.q.copy()
    bent[-1, 1] += 1e-3
    assert "end at the goal" in verdict(changed(plan, q=bent)).problem
    assert "velocity" in verdict(changed(plan, v=10.0 * rows.v)).problem
    assert "acceleration" in verdict(changed(plan, a=10.0 * rows.a)).problem
    far = rows.q.copy()
    far[len(far) // 2, 1] = 10.0
    assert "range" in verdict(changed(plan, q=far)).problem
