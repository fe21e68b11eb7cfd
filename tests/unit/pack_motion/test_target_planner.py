from __future__ import annotations

import threading

from pack_core.motion.moves import Path
from pack_core.motion.target import MotionTarget
from pack_motion.target_planner import PlanningThread, PreparedTarget


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
