from __future__ import annotations

import threading

import numpy as np

from pack_core.motion.moves import Path
from pack_core.motion.target import MotionTarget
from pack_motion.arm.arm import MotionArm
from pack_motion.reference.trajectory import JointState
from pack_motion.target_planner import PlanningThread, PreparedTarget, unwound


class Planner:
    """Plans when it is let; fails for target 13."""

    def __init__(self) -> None:
        self.let, self.done = threading.Semaphore(0), threading.Semaphore(0)
        self.begun = threading.Semaphore(0)
        self.errors: list[Exception] = []

    def prepare(self, target: MotionTarget) -> PreparedTarget:
        self.begun.release()
        self.let.acquire()
        if target.id == 13:
            raise ValueError("13")
        return PreparedTarget(target, None, "planned")


def result(thread: PlanningThread) -> PreparedTarget:
    while True:
        if prepared := thread.result():
            return prepared


def test_a_target_is_planned_once() -> None:
    planner = Planner()
    thread = PlanningThread(planner.prepare, planner.errors.append)
    thread.submit(MotionTarget(1, Path(())))
    assert thread.result() is None
    planner.let.release()
    assert result(thread).target.id == 1
    assert thread.result() is None
    thread.end()


def test_the_newest_target_replaces_one_that_is_being_planned() -> None:
    planner = Planner()
    thread = PlanningThread(planner.prepare, planner.errors.append)
    thread.submit(MotionTarget(1, Path(())))
    planner.begun.acquire()
    thread.submit(MotionTarget(2, Path(())))
    planner.let.release(2)
    assert result(thread).target.id == 2
    thread.end()


def test_a_plan_that_fails_is_a_refusal_and_the_thread_goes_on() -> None:
    planner = Planner()
    thread = PlanningThread(planner.prepare, planner.errors.append)
    planner.let.release(2)
    thread.submit(MotionTarget(13, Path(())))
    failed = result(thread)
    assert (failed.plan, failed.reason) == (None, "13")
    assert len(planner.errors) == 1
    thread.submit(MotionTarget(14, Path(())))
    assert result(thread).target.id == 14
    thread.end()


def test_a_joint_beyond_its_range_is_turned_back_and_plans_begin_at_rest(arm: MotionArm) -> None:
    wound = arm.home + 2.0 * np.pi * np.array([1, 0, 0, 0, 0, -2])
    start = unwound(JointState(wound, np.full(6, 8.0), np.full(6, 50.0)), arm.limits)
    np.testing.assert_allclose(start.q, arm.home)
    assert start.is_at_rest
