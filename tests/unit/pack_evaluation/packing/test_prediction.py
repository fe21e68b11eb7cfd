"""What the controller's model predicts, on runs whose motion is known."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pack_core import rotations
from pack_core.states import Source
from pack_evaluation.packing.measures import measure
from pack_evaluation.packing.prediction import HORIZON, held_rotation_errors, predict
from pack_evaluation.packing.run import Run
from pack_evaluation.track import Track
from unit.pack_evaluation.packing.runs import END, START, TARGET, holding_joints, make_run, still

ANGLES = st.floats(min_value=-np.pi + 0.01, max_value=np.pi - 0.01)


def test_the_model_has_the_held_object_where_the_measured_arm_holds_it() -> None:
    held = predict(make_run())[make_run().held]
    assert held.p == pytest.approx(np.tile(TARGET, (held.times.size, 1)))
    assert (held.times[0], held.times[-1]) == pytest.approx((START, END))


@settings(max_examples=15)
@given(angle=ANGLES, axis=st.tuples(*[st.floats(-1.0, 1.0)] * 3).filter(lambda v: np.linalg.norm(v) > 0.1))
def test_m_rot_is_the_angle_by_which_the_object_turned_on_the_tip(
    angle: float, axis: tuple[float, float, float]
) -> None:
    run = make_run()
    track = run.truth[run.held]
    vector = angle * np.array(axis) / np.linalg.norm(axis)
    turned = replace(track, q=np.ones((track.times.size, 1)) * rotations.exp(vector))
    true = replace(run, truth={**run.truth, run.held: turned})
    assert held_rotation_errors(true, {run.held: track}) == pytest.approx(abs(angle), abs=1e-6)
    # and the same the other way round
    assert held_rotation_errors(run, {run.held: turned}) == pytest.approx(abs(angle), abs=1e-6)


def test_m_rot_compares_the_truth_with_a_rigid_grip() -> None:
    run = make_run()
    track = run.truth[run.held]
    tilted = replace(track, q=np.ones((track.times.size, 1)) * rotations.exp([0.1, 0.0, 0.0]))
    m = measure(replace(run, truth={**run.truth, run.held: tilted}))
    assert m.m_rot == pytest.approx(0.1)
    assert m.tilt == pytest.approx(0.1)
    assert m.perception_angle == pytest.approx(0.1)  # perception did not see it either


def test_the_grip_error_is_how_far_the_object_slipped() -> None:
    run = make_run()
    track = run.truth[run.held]
    slipped = replace(track, p=track.p + np.array([0.0, 0.0, -0.004]))
    assert measure(replace(run, truth={**run.truth, run.held: slipped})).grip_error == pytest.approx(0.004)


def test_an_object_that_moves_untouched_is_wrong_by_its_way_since_the_last_start() -> None:
    run, name, speed = make_run(), "tea_box", 0.01
    track = run.truth[name]
    ramp = replace(track, p=track.p + speed * (track.times - START)[:, None] * np.array([0.0, 1.0, 0.0]))
    moved = replace(
        run, truth={**run.truth, name: ramp}, estimate={**run.estimate, name: seen(ramp.p, run, name)}
    )
    # the model starts where the object is and leaves it there: the error grows to speed * horizon, from zero
    expected = 0.5 * speed * HORIZON / len(run.scene.names)
    assert measure(moved).m_pos == pytest.approx(expected, rel=0.05)
    assert measure(moved).perception_error == 0.0


def seen(p: np.ndarray, run: Run, name: str) -> Track:
    """The estimate of an object that was seen at the positions `p` `(T, 3)`."""
    return replace(run.estimate[name], p=p)


def test_the_model_pushes_what_the_arm_pushes() -> None:
    """An object stands where the held one goes; the model has it pushed aside, the truth says it stayed."""
    run = make_run()
    in_the_way = TARGET + np.array([0.06, 0.0, -0.035])  # their sides overlap by 6 mm or so
    both = {"sugar_box": still(in_the_way)}
    stayed = replace(
        run, truth={**run.truth, **both}, estimate={**run.estimate, "sugar_box": still(in_the_way)}
    )
    pushed = predict(stayed)["sugar_box"]
    first_start = pushed.times < START + HORIZON
    assert pushed.displacement()[first_start].max() > 0.003
    assert measure(stayed).m_pos > 1e-3 / len(run.scene.names)
    assert measure(stayed).perception_error == 0.0


def test_an_object_without_any_estimate_is_left_out() -> None:
    run = make_run()
    known = {name: track for name, track in run.estimate.items() if name != "soup_can"}
    tracks = predict(replace(run, estimate=known))
    assert set(tracks) == {*run.scene.names, run.held} - {"soup_can"}
    assert np.isfinite(measure(replace(run, estimate=known)).m_pos)


def test_without_true_poses_during_the_goal_there_is_nothing_to_compare() -> None:
    run = make_run()
    before = {name: track.between(0.0, 1.0) for name, track in run.truth.items()}
    m = measure(replace(run, truth=before))
    assert np.isnan((m.m_pos, m.m_rot, m.grip_error)).all()


def test_predicted_tracks_say_that_physics_gave_them() -> None:
    assert all((track.sources == Source.PHYSICS).all() for track in predict(make_run()).values())


def test_predicting_twice_gives_the_same_bit_for_bit() -> None:
    run = make_run(joints=np.tile(holding_joints() + 0.01, (801, 1)))
    first, second = predict(run), predict(run)
    for name, track in first.items():
        np.testing.assert_array_equal(track.p, second[name].p)
