"""A goal's life: placements, stalls and every way to end."""

import numpy as np
import pytest
from numpy.typing import ArrayLike

from pack_core.packing.entry import LANDING_MARGIN, WayIn
from pack_core.packing.goals import PackingExitReason
from pack_core.packing.scene import Scene
from pack_core.rotations import Array, Pose
from pack_core.states import ObjectState, SceneState
from pack_mpc.target import Stage
from pack_mpc.task.task import PackingTask, TaskConfig

PLACE = Pose(np.array([0.5, 0.0, 0.09]))
LEFT = WayIn(np.array([-1.0, 0.0]), lean=0.3)
START = Pose(np.array([0.5, 0.0, 0.36]))


@pytest.fixture
def task(scene: Scene) -> PackingTask:
    return PackingTask(scene, TaskConfig(force_stop=40.0), 10.0)


def placed(task: PackingTask) -> PackingTask:
    task.place(PLACE, ("tea_box",), LEFT, scene_at(START))
    return task


def scene_at(X_WN: Pose) -> SceneState:
    poses = {"tea_box": Pose(np.array([0.45, 0.0, 0.065])), "passata": X_WN}
    return SceneState(10.3, {name: ObjectState(X_WO) for name, X_WO in poses.items()})


def at(height: float) -> Pose:
    return Pose(PLACE.p + np.array([0.0, 0.0, height]))


def upward(magnitudes: ArrayLike) -> Array:
    return np.outer(magnitudes, [0.0, 0.0, 1.0])


def test_a_goal_waits_for_its_placement_over_the_middle_of_the_container(
    task: PackingTask, scene: Scene
) -> None:
    task.update(10.1, START)
    target = task.machine.target.p_WN
    np.testing.assert_array_equal(target[:2], scene.container.centre)
    task.update(10.2, Pose(target))
    assert task.machine.stage is Stage.PRE_PACK
    assert task.needs_placement
    assert not placed(task).needs_placement


def test_the_object_leans_as_the_planner_says_and_as_far_as_the_weights(scene: Scene) -> None:
    task = placed(PackingTask(scene, TaskConfig(), 10.0, lean=0.3))
    np.testing.assert_allclose(task.machine.target.axis, np.sin(LEFT.lean) * LEFT.over)


@pytest.mark.parametrize("stage", [Stage.PRE_PACK, Stage.INSERT])
def test_who_knows_no_objects_goes_straight_down_wherever_they_stand(scene: Scene, stage: Stage) -> None:
    task = placed(PackingTask(scene, TaskConfig(), 10.0, lean=0.3, knows_objects=False))
    assert task.lean == 0.0
    task.machine.stage = stage
    for bottom in (0.2, 0.1, 0.05):
        task.machine.update(11.0, at(bottom))
        target = task.machine.target
        np.testing.assert_array_equal(target.axis, 0.0)
        np.testing.assert_array_equal(target.p_WN[:2], PLACE.p[:2])
        # Only the walls slow it down: it knows no tops on which it could land.
        assert target.may_land == (stage is Stage.INSERT and bottom > scene.container.height - LANDING_MARGIN)


def test_a_goal_that_reaches_its_place_is_a_success(task: PackingTask) -> None:
    placed(task).update(11.0, Pose(task.machine.target.p_WN))
    task.update(12.0, Pose(PLACE.p + np.array([0.03, 0.0, 0.01])))
    task.update(12.1, at(0.005))
    assert task.outcome is not None
    assert task.outcome.exit_reason is PackingExitReason.PLACED
    assert task.outcome.success
    assert task.outcome.execution_time == pytest.approx(2.1)
    assert task.outcome.distance == pytest.approx(0.005)


def test_a_time_out_in_fine_tune_is_a_success_and_one_before_is_not(task: PackingTask, scene: Scene) -> None:
    placed(task).update(11.0, Pose(task.machine.target.p_WN))
    task.update(12.0, Pose(PLACE.p + np.array([0.03, 0.0, 0.0])))
    assert task.machine.stage is Stage.FINE_TUNE
    task.update(30.1, Pose(PLACE.p + np.array([0.03, 0.0, 0.0])))
    early = PackingTask(scene, TaskConfig(), 10.0)
    early.update(30.1, START)
    assert task.outcome.exit_reason is early.outcome.exit_reason is PackingExitReason.TIMEOUT
    assert task.outcome.success
    assert not early.outcome.success


def test_a_stall_retreats_and_asks_for_another_placement_at_once(task: PackingTask) -> None:
    placed(task).update(11.0, Pose(task.machine.target.p_WN))
    task.update(11.1, at(0.12))
    assert not task.needs_placement
    assert task.update(14.0, at(0.12))
    assert task.machine.stage is Stage.PRE_PACK
    assert task.needs_placement
    np.testing.assert_allclose(task.avoid[0], PLACE.p)


def test_a_placement_that_comes_while_the_object_is_on_its_way_out_does_not_turn_it_round(
    task: PackingTask, scene: Scene
) -> None:
    placed(task).update(11.0, Pose(task.machine.target.p_WN))
    task.update(11.1, at(0.12))
    task.update(14.0, at(0.12))
    placed(task).update(14.1, at(0.13))
    assert task.machine.stage is Stage.PRE_PACK
    # Straight up, as it may be wedged, until it is clear of the others.
    np.testing.assert_array_equal(task.machine.target.p_WN[:2], PLACE.p[:2])
    assert task.machine.target.p_WN[2] > scene.rim


def test_without_retries_a_stall_changes_nothing(scene: Scene) -> None:
    task = placed(PackingTask(scene, TaskConfig(retries=False), 10.0))
    task.update(11.0, Pose(task.machine.target.p_WN))
    for time in np.arange(11.0, 20.0, 0.5):
        assert not task.update(float(time), at(0.08)) or time == 11.0
    assert task.machine.is_stalled
    assert task.machine.stage is Stage.INSERT
    assert not task.needs_placement


def test_after_a_stall_the_object_waits_over_the_container_for_its_placement(task: PackingTask) -> None:
    placed(task).update(11.0, Pose(task.machine.target.p_WN))
    task.update(11.1, at(0.12))
    task.update(14.0, at(0.12))
    task.update(15.0, Pose(task.machine.target.p_WN))
    assert task.machine.stage is Stage.PRE_PACK
    placed(task).update(15.1, Pose(task.machine.target.p_WN))
    assert task.machine.stage is Stage.INSERT


def test_after_a_failure_the_object_is_pushed_more_firmly(task: PackingTask) -> None:
    for failures in (0, 1, 2):
        placed(task).update(11.0, Pose(task.machine.target.p_WN))
        task.update(11.1, at(0.12))
        task.update(12.0, at(0.12))
        assert task.reliefs == failures


def test_a_rehearsed_entry_that_halts_is_pushed_ever_more_firmly(task: PackingTask) -> None:
    task.place(PLACE, ("tea_box",), LEFT, scene_at(START), is_rehearsed=True)
    task.update(11.0, Pose(task.machine.target.p_WN))
    task.update(11.1, at(0.12))
    assert task.reliefs == 0.0
    task.update(11.1 + TaskConfig().patience, at(0.12))
    assert task.reliefs == pytest.approx(1.0)
    task.update(12.0, at(0.11))
    assert task.reliefs == 0.0


def test_an_object_that_halts_short_of_its_place_is_pushed_ever_more_firmly(task: PackingTask) -> None:
    short = Pose(PLACE.p + np.array([0.02, 0.0, 0.0]))
    placed(task).update(11.0, Pose(task.machine.target.p_WN))
    task.update(11.1, short)
    assert task.machine.stage is Stage.FINE_TUNE
    task.update(11.1, short)
    task.update(11.1 + TaskConfig().patience, short)
    assert task.reliefs == pytest.approx(1.0)


def test_a_force_above_the_limit_ends_the_goal(task: PackingTask) -> None:
    task.note_forces(10.5, upward(50 * [39.0]))
    task.note_forces(10.6, upward([60.0]))
    assert task.outcome is not None
    assert task.outcome.exit_reason is PackingExitReason.FORCE
    assert task.outcome.force_mean == pytest.approx((50 * 39.0 + 60.0) / 51)
    assert task.outcome.force_peak == 60.0


def test_one_noisy_sample_does_not_end_the_goal(task: PackingTask) -> None:
    task.note_forces(10.5, upward([1.0, 60.0, 1.0]))
    assert task.outcome is None


def test_the_force_stop_is_filtered_alike_however_the_samples_are_split(scene) -> None:
    forces = upward(np.linspace(0.0, 80.0, 40))
    ends = []
    for size in (1, 7, 40):
        task = PackingTask(scene, TaskConfig(force_stop=40.0), 10.0)
        for i in range(0, 40, size):
            task.note_forces(10.0 + 0.004 * i, forces[i : i + size])
        ends.append(task.outcome is not None)
    assert all(ends)


def test_refused_placements_end_the_goal_with_the_planners_reason(task: PackingTask) -> None:
    for _ in range(TaskConfig().placement_tries):
        assert task.outcome is None
        before = task.answers
        task.refuse(10.5, "all 300 samples collide")
        assert task.answers == before + 1  # other samples are drawn
    assert task.outcome.exit_reason is PackingExitReason.NO_PLACEMENT
    assert "300" in task.outcome.message


def test_a_goal_expires_without_being_updated(task: PackingTask) -> None:
    task.expire(29.9)
    assert task.outcome is None
    task.expire(30.1)
    assert task.outcome.exit_reason is PackingExitReason.TIMEOUT


def test_a_goal_ends_once(task: PackingTask) -> None:
    task.finish(PackingExitReason.CANCELED, 10.5, "on request")
    task.finish(PackingExitReason.FAULT, 10.6, "later")
    assert task.outcome.exit_reason is PackingExitReason.CANCELED
