from pathlib import Path

import numpy as np
import pytest

from pack_core.errors import BagError
from pack_core.packing import topics
from pack_core.packing.goals import PackingExitReason
from pack_evaluation.packing.force import FILTER_TIME
from pack_evaluation.packing.from_bag import load_run
from pack_evaluation.packing.measures import measure
from unit.pack_evaluation.packing.messages import HEIGHTS, OUTCOME, TARGET, GoalWriter


def test_a_recorded_goal_measures_what_was_written(tmp_path: Path) -> None:
    writer = GoalWriter(tmp_path)
    writer.write_goal(3.0, OUTCOME)
    writer.close()
    run = load_run(tmp_path)
    m = measure(run)
    assert (run.start, run.end) == pytest.approx((3.0, 4.0))
    assert (m.success, m.exit_reason, m.iterations, m.placements) == (True, PackingExitReason.PLACED, 10, 1)
    assert m.distance == pytest.approx(HEIGHTS[1])
    assert m.force_mean == pytest.approx(1.0, abs=0.02)
    k = np.exp(-0.010 / FILTER_TIME)
    assert m.force_peak == pytest.approx((2 + k) / (1 + k + k**2))  # of 0, 1, 2, 0, 1, 2, ... every 10 ms
    assert m.iteration_ms == 20.0
    assert m.real_time_factor == 0.5
    assert run.iterations.p_WT == pytest.approx(np.tile(TARGET, (10, 1)))
    assert run.joints[:, 6] == pytest.approx(run.joint_times)


def test_of_two_goals_the_last_is_taken(tmp_path: Path) -> None:
    writer = GoalWriter(tmp_path)
    writer.write_goal(1.0, {**OUTCOME, "exit_reason": "timeout"})
    writer.write_goal(5.0, OUTCOME)
    writer.close()
    run = load_run(tmp_path)
    assert run.start == pytest.approx(5.0)
    assert run.outcome["exit_reason"] == "placed"


def test_the_result_of_an_earlier_goal_is_not_taken_for_that_of_an_unfinished_one(tmp_path: Path) -> None:
    writer = GoalWriter(tmp_path)
    writer.write_goal(1.0, OUTCOME)
    writer.write_goal(5.0, None)
    writer.close()
    run = load_run(tmp_path)
    assert run.outcome == {}
    assert measure(run).exit_reason is PackingExitReason.UNFINISHED


def test_a_goal_without_any_placement_is_a_run_without_iterations(tmp_path: Path) -> None:
    writer = GoalWriter(tmp_path, without=(topics.MPC_STATUS,))
    writer.write_goal(2.0, {**OUTCOME, "exit_reason": "no_placement", "success": False})
    writer.close()
    run = load_run(tmp_path)
    assert run.iterations.times.size == 0
    assert (run.start, run.end) == pytest.approx((2.0, 3.0))
    assert measure(run).exit_reason is PackingExitReason.NO_PLACEMENT


def test_a_bag_without_a_goal_is_refused_in_words(tmp_path: Path) -> None:
    writer = GoalWriter(tmp_path, without=(topics.MPC_STATUS, topics.RESULT))
    writer.write_goal(2.0)
    writer.close()
    with pytest.raises(BagError, match=r"/mpc/status .*was a goal sent\?"):
        load_run(tmp_path)


def test_a_bag_that_lacks_a_node_names_its_topic(tmp_path: Path) -> None:
    writer = GoalWriter(tmp_path, without=(topics.SCENE,))
    writer.write_goal(2.0, OUTCOME)
    writer.close()
    with pytest.raises(BagError, match=r"no message on /scene: was the node that sends it running\?"):
        load_run(tmp_path)
