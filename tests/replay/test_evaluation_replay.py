import numpy as np
import pytest

from pack_core.packing.goals import PackingExitReason
from pack_evaluation.packing.criteria import Criteria, judge
from pack_evaluation.packing.from_bag import load_run
from pack_evaluation.packing.measures import goal_force, measure
from replay.sample import COUNTS, sample, sample_path


def test_the_evaluation_agrees_with_what_the_controller_reported() -> None:
    assert sample().counts()["/mpc/status"] == COUNTS["/mpc/status"]
    run = load_run(sample_path())
    m = measure(run)
    assert m.success == run.outcome["success"]
    assert m.exit_reason is PackingExitReason(run.outcome["exit_reason"])
    assert m.execution_time == pytest.approx(run.outcome["execution_time"])
    assert m.distance == pytest.approx(run.outcome["distance"], abs=2e-3)
    assert np.max(goal_force(run)[1]) == pytest.approx(run.outcome["force_peak"])
    assert m.placements == run.outcome["placements"]


def test_the_recorded_motion_alone_says_how_the_goal_ended() -> None:
    run = load_run(sample_path())
    assert judge(run, Criteria()) is PackingExitReason(run.outcome["exit_reason"])


def test_perception_contact_and_lateness_are_measured_from_the_recording() -> None:
    m = measure(load_run(sample_path()))
    # the sample's cup is rigid: the object is exactly where the measured joints have it
    assert (m.m_rot, m.grip_error) == pytest.approx((0.0, 0.0), abs=1e-6)
    assert 0.0 < m.perception_error < 0.001
    assert 0.0 < m.m_pos < 0.002
    assert m.is_contained
    assert m.protrusion < 0.003
    assert 0.04 < m.chatter < 0.07
    assert 0.0 < m.very_late < 0.1 < 0.5 < m.late < 0.6  # recorded on a slow machine
