"""What the estimator does with samples and frames of one time or another, of an arm at home."""

from __future__ import annotations

import numpy as np
import pytest

from pack_core.joints import JointSample
from pack_core.packing.cell import packing_cell
from pack_core.packing.markers import MarkerFrame
from pack_core.rotations import Array
from pack_core.states import ObjectState, Source
from pack_perception.mocap.physics_estimator import EstimatorConfig, PhysicsEstimator
from unit.pack_perception.mocap.pushing import standing_scene

CELL, SCENE, CONFIG = packing_cell(), standing_scene(), EstimatorConfig()
HOME, LIMITS = np.array(CELL.robot.home), CELL.robot.arm.limits
HELD, STEP, START = SCENE.new_object.name, CONFIG.step, 5.0


def sample(time: float, q: Array = HOME, v: Array | None = None) -> JointSample:
    return JointSample(time, q, np.zeros(7) if v is None else v, np.zeros(7))


PLACES = {item.name: np.array(item.pose.position) for item in SCENE.objects}
"""Where the objects stand, none of them turned [m]."""
TEA_BOX = PLACES["tea_box"]


def frame(time: float, *shift: float) -> MarkerFrame:
    """All markers of all objects where they stand, those of the tea box displaced [m]."""
    shifts = {"tea_box": np.array(shift or (0.0, 0.0, 0.0))}
    p_WM = [item.markers() + PLACES[item.name] + shifts.get(item.name, 0.0) for item in SCENE.objects]
    objects, markers = np.divmod(np.arange(len(p_WM) * len(p_WM[0])), len(p_WM[0]))
    cameras = np.full(len(objects), 3)
    return MarkerFrame(time, tuple(PLACES), objects, markers, np.concatenate(p_WM), cameras)


@pytest.fixture
def estimator() -> PhysicsEstimator:
    return PhysicsEstimator(SCENE.description(), CELL, CONFIG)


@pytest.fixture
def started(estimator: PhysicsEstimator) -> PhysicsEstimator:
    estimator.advance(sample(START))
    return estimator


def tea_box(estimator: PhysicsEstimator, time: float) -> ObjectState:
    return estimator.state(time).objects["tea_box"]


def test_before_the_first_sample_every_sample_is_wanted_and_every_frame_waits(
    estimator: PhysicsEstimator,
) -> None:
    assert np.isnan(estimator.time)
    assert estimator.wants(0.0)
    assert estimator.is_ahead(frame(0.0))


@pytest.mark.parametrize(
    ("later", "is_wanted"),
    [
        (0.0, False),
        (0.5 * STEP, False),
        (STEP - 2e-6, False),
        (STEP - 5e-7, True),
        (STEP, True),
        (1.0, True),
        (-1e-4, True),
    ],
)
def test_samples_less_than_a_step_later_are_skipped(
    started: PhysicsEstimator, later: float, is_wanted: bool
) -> None:
    assert started.wants(START + later) is is_wanted
    started.advance(sample(START + later))
    assert started.time == (START + later if is_wanted else START)


@pytest.mark.parametrize(("steps", "is_ahead"), [(-1.0, False), (0.0, False), (1.99, False), (2.01, True)])
def test_a_frame_waits_while_it_is_two_steps_ahead(
    started: PhysicsEstimator, steps: float, is_ahead: bool
) -> None:
    assert started.is_ahead(frame(START + steps * STEP)) is is_ahead


@pytest.mark.parametrize(("gap", "is_restart"), [(0.99, False), (1.01, True)])
def test_a_gap_longer_than_the_longest_one_starts_over(
    started: PhysicsEstimator, gap: float, is_restart: bool
) -> None:
    assert started.advance(sample(START + gap * CONFIG.max_gap)).is_restart is is_restart


def test_neither_the_first_sample_nor_one_given_twice_starts_over(estimator: PhysicsEstimator) -> None:
    assert not estimator.advance(sample(START)).is_restart
    assert not estimator.advance(sample(START)).is_restart


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("joint", [0, 6])
@pytest.mark.parametrize("gap", [STEP, 0.1])
def test_an_arm_much_faster_than_its_limits_was_put_elsewhere(
    started: PhysicsEstimator, gap: float, joint: int, sign: float
) -> None:
    reach = sign * CONFIG.teleport * LIMITS.velocity[joint] * gap * np.eye(7)[joint]
    assert not started.advance(sample(START + gap, HOME + 0.99 * reach)).is_restart
    assert started.advance(sample(START + 2 * gap, HOME + 2.01 * reach)).is_restart


def test_two_samples_of_one_time_may_differ_by_what_a_millisecond_allows(started: PhysicsEstimator) -> None:
    reach = CONFIG.teleport * LIMITS.velocity * 1e-3
    assert not started.advance(sample(START, HOME + 0.99 * reach)).is_restart
    assert started.advance(sample(START, HOME + 1.01 * reach)).is_restart


def test_a_state_is_extrapolated_by_a_step_at_most_and_never_backwards(started: PhysicsEstimator) -> None:
    v = np.array([0.5, 0.2, 0.0, 0.0, 0.0, 0.0, 0.0])
    for k in range(1, 11):
        started.advance(sample(START + k * STEP, HOME + k * STEP * v, v))
    now = started.time
    here = started.state(now).objects[HELD]
    assert np.linalg.norm(here.v_WO_W) > 0.1
    for ahead, counted in ((-0.1, 0.0), (0.25 * STEP, 0.25 * STEP), (STEP, STEP), (1.0, STEP)):
        there = started.state(now + ahead).objects[HELD]
        np.testing.assert_allclose(there.X_WO.p - here.X_WO.p, counted * here.v_WO_W, atol=1e-12)
        np.testing.assert_array_equal(there.v_WO_W, here.v_WO_W)


def test_an_age_counts_from_the_last_sight_or_the_start_and_is_never_negative(
    started: PhysicsEstimator,
) -> None:
    assert started.state(START + 0.5).objects[HELD].age == pytest.approx(0.5)
    started.advance(sample(START + 0.1))
    started.correct(frame(START + 0.05))
    assert tea_box(started, START + 0.2).age == pytest.approx(0.15)
    assert tea_box(started, START).age == 0.0
    assert started.state(START + 0.2).objects[HELD].age == pytest.approx(0.2)


def test_a_pose_is_the_markers_own_for_a_while(started: PhysicsEstimator) -> None:
    started.advance(sample(START + 0.1))
    started.correct(frame(START + 0.1))
    for age, source in ((0.99, Source.MOCAP), (1.01, Source.PHYSICS)):
        assert tea_box(started, START + 0.1 + age * CONFIG.mocap_age).source is source
    assert started.state(START + 0.1).objects[HELD].source is Source.PHYSICS


def steps(estimator: PhysicsEstimator, count: int) -> None:
    """Samples of an arm at rest."""
    for k in range(1, count + 1):
        estimator.advance(sample(START + k * STEP))


def test_a_first_sight_puts_an_object_where_it_is_seen(started: PhysicsEstimator) -> None:
    seen = started.correct(frame(START, 0.003, 0.0, 0.0))
    assert set(seen.seen) == set(PLACES)
    found = tea_box(started, START)
    np.testing.assert_allclose(found.X_WO.p - TEA_BOX, [0.003, 0.0, 0.0], atol=1e-9)
    np.testing.assert_array_equal(found.v_WO_W, 0.0)


def test_a_small_error_at_the_next_sight_is_corrected_by_the_gains(started: PhysicsEstimator) -> None:
    period, gains = 2 * STEP, CONFIG.correction
    started.correct(frame(START))
    steps(started, 2)
    before = tea_box(started, started.time)
    started.correct(frame(START + period, 0.002, 0.0, 0.0))
    after = tea_box(started, started.time)
    error = TEA_BOX + np.array([0.002, 0.0, 0.0]) - before.X_WO.p
    np.testing.assert_allclose(after.X_WO.p - before.X_WO.p, gains.pose_gain * error, atol=1e-9)
    np.testing.assert_allclose(after.v_WO_W - before.v_WO_W, gains.twist_gain / period * error, atol=1e-9)


def test_a_jump_puts_an_object_anew_and_at_rest(started: PhysicsEstimator) -> None:
    started.correct(frame(START))
    steps(started, 2)
    jump = np.array([0.0, 0.0, 1.1 * CONFIG.correction.jump])
    started.correct(frame(START + 2 * STEP, *jump))
    found = tea_box(started, started.time)
    np.testing.assert_allclose(found.X_WO.p - TEA_BOX, jump, atol=1e-9)
    np.testing.assert_array_equal(found.v_WO_W, 0.0)


def test_late_frames_are_compared_with_the_poses_of_their_time_as_corrected_since(
    started: PhysicsEstimator,
) -> None:
    started.correct(frame(START, 0.01, 0.0, 0.0))
    steps(started, 5)
    errors = []
    for k in (1, 3, 5):
        started.correct(frame(START + k * STEP))
        errors.append((tea_box(started, started.time).X_WO.p - TEA_BOX)[0])
    kept = 1.0 - CONFIG.correction.pose_gain
    np.testing.assert_allclose(errors, 0.01 * kept ** np.array([1, 2, 3]), rtol=0.02)
