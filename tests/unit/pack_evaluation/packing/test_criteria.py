from dataclasses import replace

import numpy as np
import pytest

from pack_core.packing.goals import PackingExitReason
from pack_evaluation.packing.criteria import Criteria, exit_reason, is_packed, judge
from pack_evaluation.packing.measures import measure
from pack_evaluation.packing.run import Iterations
from unit.pack_evaluation.packing.runs import END, START, iterations, make_run

NOTHING = Iterations(
    *(np.empty(0),) * 2, (), *(np.empty(0),) * 4, np.empty((0, 3)), np.empty((0, 4)), ()
)  # fmt: skip


def test_fine_tune_reached_is_packed_even_if_the_goal_then_timed_out() -> None:
    assert is_packed(make_run(outcome={"exit_reason": "timeout", "success": False}))


def test_without_fine_tune_nothing_is_packed() -> None:
    assert not is_packed(make_run(iterations=iterations(("PRE_PACK", "INSERT"))))


def test_a_recorded_exit_goes_before_a_judged_one() -> None:
    assert (
        exit_reason(make_run(outcome={"exit_reason": "canceled"}), Criteria()) is PackingExitReason.CANCELED
    )


def test_within_the_threshold_in_fine_tune_is_placed() -> None:
    assert judge(make_run(), Criteria()) is PackingExitReason.PLACED


def test_outside_the_threshold_is_not_placed() -> None:
    run = make_run()
    held = run.estimate[run.held]
    off = {**run.estimate, run.held: replace(held, p=held.p + np.array([0.0, 0.0, 0.016]))}
    assert judge(replace(run, estimate=off), Criteria()) is PackingExitReason.UNFINISHED
    assert judge(replace(run, estimate=off), Criteria(distance=0.017)) is PackingExitReason.PLACED


@pytest.mark.parametrize(
    ("timeout", "expected"), [(END - START, PackingExitReason.TIMEOUT), (5.0, PackingExitReason.UNFINISHED)]
)
def test_a_goal_that_ran_its_time_timed_out(timeout: float, expected: PackingExitReason) -> None:
    run = make_run(iterations=iterations(("PRE_PACK", "INSERT")))
    assert judge(run, Criteria(timeout=timeout)) is expected


def test_a_released_object_is_detached() -> None:
    assert judge(make_run(release_reason="pull 61 N"), Criteria()) is PackingExitReason.DETACHED


def test_a_force_above_the_limit_ends_the_run_only_within_the_goal() -> None:
    run = make_run()
    early = np.where(run.force_times < START, 50.0, 0.0)
    assert judge(replace(run, force=early), Criteria(force=40.0)) is PackingExitReason.PLACED
    assert (
        judge(replace(run, force=np.full_like(early, 50.0)), Criteria(force=40.0)) is PackingExitReason.FORCE
    )


def test_a_goal_without_a_placement_has_a_table_too() -> None:
    outcome = {"exit_reason": "no_placement", "success": False, "placements": 0}
    m = measure(make_run(iterations=NOTHING, outcome=outcome))
    assert (m.success, m.exit_reason, m.placements, m.iterations) == (
        False,
        PackingExitReason.NO_PLACEMENT,
        0,
        0,
    )
    assert np.isnan(m.distance)
    assert judge(make_run(iterations=NOTHING), Criteria()) is PackingExitReason.NO_PLACEMENT
