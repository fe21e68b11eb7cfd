"""Looking for objects without a pose: where the held object goes, and how it ends."""

import numpy as np
import pytest

from pack_core.packing.goals import PackingExitReason
from pack_core.packing.scene import Scene
from pack_core.rotations import Pose, exp, rotate
from pack_core.states import ObjectState, SceneState
from pack_mpc.cost.weights import load_weights
from pack_mpc.observation import unseen_of, with_parked
from pack_mpc.target import Stage
from pack_mpc.task.look import LookConfig, LookMachine, look_poses
from pack_mpc.task.stages import UP, StageMachine
from pack_mpc.task.task import PackingTask, TaskConfig

START = Pose(np.array([0.5, 0.0, 0.36]))
HIDDEN = ("tea_box",)
CONFIG = LookConfig()
LATER = 1e-6
"""More than the rounding of times [s]."""


@pytest.fixture
def look(scene: Scene) -> LookMachine:
    return LookMachine(scene, CONFIG, 10.0, START)


@pytest.fixture
def task(scene: Scene) -> PackingTask:
    return PackingTask(scene, TaskConfig(), 10.0)


def follow(look: LookMachine, time: float) -> float:
    """Reach one look pose and stay until the next one is due; the time then [s]."""
    look.update(time, Pose(look.target.p_WN), HIDDEN)
    time += CONFIG.dwell + LATER
    look.update(time, Pose(look.target.p_WN), HIDDEN)
    return time


def test_the_object_goes_straight_up_before_it_goes_beside_the_container(scene: Scene) -> None:
    here, above, *beside = look_poses(scene, CONFIG, START)
    np.testing.assert_array_equal(here.p_WN, START.p)
    np.testing.assert_array_equal(above.p_WN[:2], START.p[:2])
    half = scene.new_object.half_extents
    for pose in (above, *beside):
        assert pose.p_WN[2] - half[2] >= scene.rim + CONFIG.height - 1e-9
    for pose in beside:
        nearest = np.clip(pose.p_WN[:2], scene.container.lower, scene.container.upper)
        assert np.linalg.norm(pose.p_WN[:2] - nearest) > CONFIG.aside + np.linalg.norm(half[:2])


def test_an_object_that_is_high_enough_does_not_come_down_to_look(scene: Scene) -> None:
    high = Pose(START.p + np.array([0.0, 0.0, 0.4]))
    assert {pose.p_WN[2] for pose in look_poses(scene, CONFIG, high)} == {high.p[2]}


def test_a_tilted_object_comes_up_as_it_is_and_is_upright_beside_the_container(scene: Scene) -> None:
    tilted = Pose(START.p, exp([0.3, 0.0, 0.0]))
    _, above, *beside = look_poses(scene, CONFIG, tilted)
    np.testing.assert_allclose(above.axis, rotate(tilted.q, UP)[:2])
    for pose in beside:
        np.testing.assert_array_equal(pose.axis, 0.0)


def test_the_cameras_have_their_time_at_each_look_pose(look: LookMachine) -> None:
    assert not look.update(10.0, START, HIDDEN)
    assert not look.update(10.0 + 0.9 * CONFIG.dwell, START, HIDDEN)
    assert look.update(10.0 + CONFIG.dwell + LATER, START, HIDDEN)
    assert look.target.p_WN[2] > START.p[2]


def test_a_look_pose_out_of_reach_is_given_up(look: LookMachine) -> None:
    time = follow(look, 10.0)
    short = Pose(look.target.p_WN - np.array([0.0, 0.0, 2 * CONFIG.near]))
    assert not look.update(time + 0.9 * CONFIG.travel_time, short, HIDDEN)
    assert look.update(time + CONFIG.travel_time + LATER, short, HIDDEN)
    assert not look.is_exhausted


def test_an_object_that_does_not_come_out_of_the_container_is_not_taken_over_its_wall(scene: Scene) -> None:
    wedged = Pose(np.array([0.5, 0.0, 0.12]))
    look = LookMachine(scene, CONFIG, 10.0, wedged)
    look.update(10.0, wedged, HIDDEN)
    assert look.update(10.0 + CONFIG.dwell + LATER, wedged, HIDDEN)
    assert not look.update(20.0, wedged, HIDDEN)
    assert look.is_exhausted
    np.testing.assert_array_equal(look.target.p_WN[:2], wedged.p[:2])


def test_a_look_that_finds_nothing_says_what_is_missing_and_where_it_looked_from(look: LookMachine) -> None:
    time = 10.0
    while not look.is_exhausted:
        time = follow(look, time)
        assert time < 12.0
    assert "tea_box, with the held object where it was, above, left of the container" in look.report


def test_a_goal_looks_first_and_then_goes_on_as_ever(task: PackingTask) -> None:
    assert not task.update(10.1, START, HIDDEN)
    assert task.machine.stage is Stage.LOOK
    assert task.update(10.2, START)
    assert isinstance(task.machine, StageMachine)
    assert task.machine.stage is Stage.PRE_PACK
    assert task.needs_placement


def test_a_goal_that_sees_everything_does_not_look(task: PackingTask) -> None:
    assert not task.update(10.1, START)
    assert task.machine.stage is Stage.PRE_PACK


def test_a_goal_ends_without_placement_when_looking_does_not_help(task: PackingTask) -> None:
    time = 10.0
    while task.outcome is None:
        task.update(time, Pose(task.machine.target.p_WN) if task.machine else START, HIDDEN)
        time += 0.1
    assert task.outcome.exit_reason is PackingExitReason.NO_PLACEMENT
    assert not task.outcome.success
    assert "tea_box" in task.outcome.message


def test_time_runs_out_while_looking_as_at_any_other_time(scene: Scene) -> None:
    task = PackingTask(scene, TaskConfig(timeout=1.0), 10.0)
    task.update(11.1, START, HIDDEN)
    assert task.outcome.exit_reason is PackingExitReason.TIMEOUT
    assert "stage look" in task.outcome.message


def test_objects_without_a_pose_are_kept_out_of_the_way_of_the_plan(scene: Scene, state: SceneState) -> None:
    seen = {name: item for name, item in state.objects.items() if name not in HIDDEN}
    partly = SceneState(state.time, seen)
    assert unseen_of(scene, partly) == HIDDEN
    whole = with_parked(scene, partly)
    assert unseen_of(scene, whole) == ()
    assert {name: whole.objects[name] for name in seen} == seen
    parked: ObjectState = whole.objects["tea_box"]
    assert np.linalg.norm(parked.X_WO.p[:2]) > 3.0


def test_looking_weighs_as_pre_packing_does() -> None:
    weights = load_weights("tuned")
    assert weights.of(Stage.LOOK) == weights.of(Stage.PRE_PACK)
