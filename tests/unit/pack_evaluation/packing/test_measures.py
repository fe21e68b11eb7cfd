import math
from dataclasses import replace

import numpy as np
import pytest

from pack_core import rotations
from pack_core.packing.goals import PackingExitReason
from pack_core.states import Source
from pack_evaluation.packing.measures import measure, object_displacements, predicted_objects
from pack_evaluation.packing.run import Run
from pack_evaluation.track import Track
from unit.pack_evaluation.packing.runs import END, START, TARGET, iterations, make_run, still


def shifted(track: Track, offset: tuple[float, float, float]) -> Track:
    return replace(track, p=track.p + np.array(offset))


def turned(track: Track, angle: float) -> Track:
    return replace(track, q=np.ones((track.times.size, 1)) * rotations.exp([0.0, angle, 0.0]))


def test_a_run_in_which_nothing_is_wrong_measures_zero() -> None:
    m = measure(make_run())
    assert (m.success, m.exit_reason, m.execution_time) == (True, PackingExitReason.PLACED, END - START)
    assert (m.distance, m.perception_error, m.perception_angle, m.m_per, m.displacement) == (0, 0, 0, 0, 0)
    assert (m.m_rot, m.grip_error) == pytest.approx((0.0, 0.0), abs=1e-8)
    assert m.m_pos == pytest.approx(0.0, abs=1e-4)  # soft contact gives way under the weight
    assert (m.is_contained, m.protrusion, m.tilt, m.force_peak) == (True, 0.0, 0.0, 0.0)
    assert m.real_time_factor == pytest.approx(0.5)


def test_estimates_off_by_three_and_four_millimetres_are_five_on_average() -> None:
    run = make_run()
    off = {name: shifted(track, (0.003, 0.004, 0.0)) for name, track in run.estimate.items()}
    m = measure(replace(run, estimate=off))
    assert m.perception_error == pytest.approx(0.005)
    assert m.m_pos == pytest.approx(0.005, abs=1e-4)  # the model starts from what perception says


def test_one_wrong_object_counts_for_its_share() -> None:
    run = make_run()
    name = run.scene.names[0]
    off = {**run.estimate, name: shifted(run.estimate[name], (0.010, 0.0, 0.0))}
    assert measure(replace(run, estimate=off)).perception_error == pytest.approx(0.010 / len(run.scene.names))


def test_perceptions_rotation_error_is_the_angle_of_the_held_object() -> None:
    run = make_run()
    held = run.estimate[run.held]
    m = measure(replace(run, estimate={**run.estimate, run.held: turned(held, 0.2)}))
    assert m.perception_angle == pytest.approx(0.2)
    assert m.m_rot == pytest.approx(0.0, abs=1e-8)  # of the model, which does not ask perception for it


def test_an_object_hidden_for_half_of_the_goal_counts_one_half() -> None:
    run = make_run()
    name = run.scene.names[1]
    track = run.estimate[name]
    middle = 0.5 * (START + END)
    sources = np.where(track.times < middle, Source.PHYSICS, Source.MOCAP).astype(np.uint8)
    hidden = replace(run, estimate={**run.estimate, name: replace(track, sources=sources)})
    assert measure(hidden).m_per == pytest.approx(0.5, abs=0.01)


def test_an_object_never_seen_counts_all_the_time() -> None:
    run = make_run()
    unseen = run.scene.names[1]
    estimate = {name: track for name, track in run.estimate.items() if name != unseen}
    assert measure(replace(run, estimate=estimate)).m_per == pytest.approx(1.0)


def test_an_object_counts_until_it_is_first_seen() -> None:
    run = make_run()
    name = run.scene.names[1]
    late = run.estimate[name].between(START + 0.25 * (END - START), np.inf)
    assert measure(replace(run, estimate={**run.estimate, name: late})).m_per == pytest.approx(0.25, abs=0.01)


def test_an_estimate_that_came_twice_counts_once() -> None:
    run = make_run()
    twice = {name: track.at(np.repeat(track.times, 2)) for name, track in run.estimate.items()}
    assert measure(replace(run, estimate=twice)).m_per == 0.0


def test_without_an_estimate_there_is_no_number_of_objects_not_seen() -> None:
    assert math.isnan(predicted_objects(replace(make_run(), estimate={})))


def test_a_hidden_held_object_does_not_count_among_those_in_the_container() -> None:
    run = make_run()
    held = still(TARGET, Source.PHYSICS)
    assert measure(replace(run, estimate={**run.estimate, run.held: held})).m_per == 0.0


def test_force_is_measured_within_the_goal_only() -> None:
    times = np.linspace(0.0, 8.0, 801)
    force = np.where((times >= START) & (times <= END), times - START, 1000.0)
    m = measure(make_run(force_times=times, force=force))
    assert m.force_mean == pytest.approx(2.0)
    assert m.force_p95 == pytest.approx(3.8)
    assert m.force_peak == pytest.approx(4.0, abs=0.005)


def test_final_distance_is_that_of_the_truth_at_the_end() -> None:
    run = make_run()
    truth = {**run.truth, run.held: shifted(run.truth[run.held], (0.0, 0.0, 0.02))}
    assert measure(replace(run, truth=truth)).distance == pytest.approx(0.02)


def test_displacement_sums_over_the_objects_in_the_container() -> None:
    run = make_run()
    first, second = run.scene.names[:2]
    moved = {name: ramp(run, name, metres) for name, metres in ((first, 0.04), (second, 0.03))}
    pushed = replace(run, truth={**run.truth, **moved})
    assert object_displacements(pushed)[first] == pytest.approx(0.04)
    assert measure(pushed).displacement == pytest.approx(0.07)


def ramp(run: Run, name: str, metres: float) -> Track:
    """The object's track, but moving by `metres` along y during the goal."""
    track = run.truth[name]
    done = np.clip((track.times - START) / (END - START), 0.0, 1.0)
    return replace(track, p=track.p + metres * done[:, None] * np.array([0.0, 1.0, 0.0]))


def test_late_iterations_are_those_over_one_and_over_two_cycles() -> None:
    run = make_run(iterations=iterations(("PRE_PACK",) * 4))
    slow = replace(run.iterations, ms=np.array([20.0, 48.0, 60.0, 97.0]))
    m = measure(replace(run, iterations=slow))
    assert (m.late, m.very_late) == (0.5, 0.25)


def test_under_load_are_iterations_from_a_late_one_on() -> None:
    run = make_run(iterations=iterations(("PRE_PACK",) * 4))
    quick, slow = (replace(run.iterations, times=START + period * np.arange(4)) for period in (0.04, 0.1))
    assert measure(replace(run, iterations=quick)).given_up == 0.0
    assert measure(replace(run, iterations=slow)).given_up == 0.75


def test_iteration_times_are_median_and_percentile() -> None:
    m = measure(make_run())
    assert (m.iteration_ms, m.iterations) == (20.0, 3)
    assert m.iteration_ms_p95 == pytest.approx(29.0)
