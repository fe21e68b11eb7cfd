"""Objects are found by their markers and carried by physics while hidden."""

from __future__ import annotations

from collections import deque
from dataclasses import replace

import numpy as np
import pytest

from pack_core.packing.cell import packing_cell
from pack_core.packing.markers import MarkerFrame
from pack_core.packing.scene import Scene
from pack_core.rotations import angle_between
from pack_core.states import SceneState, Source
from pack_perception.mocap.physics_estimator import Correction, EstimatorConfig, PhysicsEstimator
from pack_perception.mocap.rigid_body_fit import FitRefusal
from pack_sim.packing.simulator import Simulator, SimulatorConfig
from unit.pack_perception.mocap.pushing import (
    CONTACT,
    Moment,
    only,
    pushing_run,
    standing_scene,
    without,
)

CONFIG = EstimatorConfig()
SCENE = standing_scene()
HELD = SCENE.new_object.name
EVERYTHING = {*SCENE.names, HELD}
SETTLED = 0.3
SWAP = {"tea_box": "cracker_box", "cracker_box": "tea_box"}


@pytest.fixture(scope="module")
def moments() -> list[Moment]:
    """One recorded run of pushing; tests share it and change nothing in it."""
    return list(pushing_run(seed=0))


@pytest.fixture
def estimator() -> PhysicsEstimator:
    return PhysicsEstimator(SCENE.description(), packing_cell(), CONFIG)


def feed(estimator: PhysicsEstimator, moment: Moment, hidden: set[str] | None = None) -> None:
    estimator.advance(moment.joints)
    for frame in moment.frames:
        estimator.correct(without(frame, hidden or set()))


def show(
    estimator: PhysicsEstimator, moment: Moment, markers: dict[str, tuple[int, ...]]
) -> list[Correction]:
    """Feed a moment in which only some markers of some objects are seen."""
    estimator.advance(moment.joints)
    frames = moment.frames
    for name, those in markers.items():
        frames = [only(frame, name, those) for frame in frames]
    return [estimator.correct(frame) for frame in frames]


def distances(state: SceneState, truth: SceneState) -> dict[str, float]:
    return {
        name: float(np.linalg.norm(item.X_WO.p - truth.objects[name].X_WO.p))
        for name, item in state.objects.items()
    }


def travel(moments: list[Moment], name: str, since: float) -> float:
    first = next(m for m in moments if m.joints.time >= since)
    return float(np.linalg.norm(moments[-1].truth.objects[name].X_WO.p - first.truth.objects[name].X_WO.p))


@pytest.mark.parametrize("hidden", [{"tea_box"}, EVERYTHING], ids=["the pushed box", "everything"])
def test_objects_hidden_for_two_seconds_of_pushing_stay_within_5_mm(
    estimator: PhysicsEstimator, moments: list[Moment], hidden: set[str]
) -> None:
    assert travel(moments, "tea_box", CONTACT) > 0.03
    for moment in moments:
        feed(estimator, moment, hidden if moment.joints.time > CONTACT else None)
        if moment.joints.time > SETTLED:
            errors = distances(estimator.state(moment.joints.time), moment.truth)
            assert set(errors) == EVERYTHING
            assert max(errors.values()) < 0.005
    pushed = estimator.state(estimator.time).objects["tea_box"]
    assert pushed.source is Source.PHYSICS
    assert pushed.age > 2.0


def test_objects_in_sight_stay_within_2_mm_while_they_are_pushed(
    estimator: PhysicsEstimator, moments: list[Moment]
) -> None:
    for moment in moments:
        feed(estimator, moment)
        if moment.joints.time > SETTLED:
            state = estimator.state(moment.joints.time)
            assert max(distances(state, moment.truth).values()) < 0.002
            assert state.objects["tea_box"].source is Source.MOCAP


def test_frames_that_arrive_very_late_are_used_at_their_exposure(
    estimator: PhysicsEstimator, moments: list[Moment]
) -> None:
    delayed: deque[MarkerFrame] = deque()
    for moment in moments:
        delayed.extend(moment.frames)
        frames = []
        while delayed and delayed[0].time < moment.joints.time - 0.12:
            frames.append(delayed.popleft())
        feed(estimator, replace(moment, frames=frames))
        if moment.joints.time > 2 * SETTLED:
            assert max(distances(estimator.state(moment.joints.time), moment.truth).values()) < 0.003


def test_an_object_is_unknown_until_it_is_seen(estimator: PhysicsEstimator, moments: list[Moment]) -> None:
    for moment in moments[:100]:
        feed(estimator, moment, hidden={"tea_box", "soup_can"})
    assert set(estimator.state(estimator.time).objects) == EVERYTHING - {"tea_box", "soup_can"}
    for moment in moments[100:110]:
        feed(estimator, moment)
    assert set(estimator.state(estimator.time).objects) == EVERYTHING


def test_two_markers_place_what_stands_and_nobody_calls_it_tracked(
    estimator: PhysicsEstimator, moments: list[Moment]
) -> None:
    few = {"tea_box": (0, 1), "soup_can": (1, 2), "sugar_box": (3,)}
    corrections = [c for moment in moments[:250] for c in show(estimator, moment, few)]
    assert corrections[-1].partly == ("soup_can", "tea_box")
    assert corrections[-1].refused == {"sugar_box": FitRefusal.TOO_FEW}
    state = estimator.state(estimator.time)
    assert "sugar_box" not in state.objects
    for name in ("tea_box", "soup_can"):
        found, truth = state.objects[name], moments[249].truth.objects[name]
        assert found.source is Source.PHYSICS
        assert found.age < 0.05
        assert np.linalg.norm(found.X_WO.p - truth.X_WO.p) < 0.001
        assert angle_between(found.X_WO.q, truth.X_WO.q) < np.deg2rad(1.0)


def test_two_markers_correct_what_physics_gets_wrong(moments: list[Moment]) -> None:
    """The estimator takes the held box for a thinner one, which pushes later and less far."""
    thinner = SCENE.new_object.model_copy(update={"size": (0.04, 0.04, 0.18)})
    described = SCENE.description().model_copy(update={"new_object": thinner})
    final = {}
    for markers in ((0, 1), (0,)):
        estimator = PhysicsEstimator(described, packing_cell(), CONFIG)
        for moment in moments:
            show(estimator, moment, {"tea_box": markers} if moment.joints.time > CONTACT else {})
        state = estimator.state(estimator.time)
        assert state.objects["tea_box"].source is Source.PHYSICS
        final[markers] = distances(state, moments[-1].truth)["tea_box"]
    assert final[0, 1] < 0.001
    assert final[0,] > 0.01


def test_two_markers_of_what_does_not_stand_give_no_pose(
    estimator: PhysicsEstimator, moments: list[Moment]
) -> None:
    """Two markers of the cracker box come under the name of the tea box, which is two centimetres lower."""
    corrections = []
    for moment in moments[:100]:
        frames = [only(frame, "cracker_box", (0, 1)) for frame in moment.frames]
        named = [replace(frame, objects=tuple(SWAP.get(n, n) for n in frame.objects)) for frame in frames]
        corrections += show(estimator, replace(moment, frames=named), {"cracker_box": (0, 1)})
    assert corrections[-1].refused["tea_box"] is FitRefusal.NOT_STANDING
    assert "tea_box" not in estimator.state(estimator.time).objects


def test_the_held_object_follows_from_the_joints_alone(
    estimator: PhysicsEstimator, moments: list[Moment]
) -> None:
    for moment in moments:
        estimator.advance(moment.joints)
    state = estimator.state(estimator.time)
    assert set(state.objects) == {HELD}
    assert state.objects[HELD].source is Source.PHYSICS
    held, truth = state.objects[HELD], moments[-1].truth.objects[HELD]
    assert np.allclose(held.X_WO.p, truth.X_WO.p, atol=2e-4)
    assert np.allclose(held.v_WO_W, truth.v_WO_W, atol=2e-3)


def test_an_object_that_falls_off_the_cup_is_tracked_like_the_others() -> None:
    cell = packing_cell()
    simulator = Simulator(cell, SCENE, SimulatorConfig(), np.random.default_rng(0))
    estimator = PhysicsEstimator(SCENE.description(), cell, CONFIG)
    while simulator.time < 2.0:
        simulator.step()
        if 0.3 < simulator.time < 0.302:
            assert estimator.is_held
            simulator.release()
        estimator.advance(simulator.joints())
        for frame in simulator.mocap.due(simulator.time):
            estimator.correct(frame)
    truth, state = simulator.truth(), estimator.state(estimator.time)
    assert truth.objects[HELD].X_WO.p[2] < 0.3
    assert not estimator.is_held
    assert distances(state, truth)[HELD] < 0.005


def test_time_that_runs_backwards_starts_over(estimator: PhysicsEstimator, moments: list[Moment]) -> None:
    for moment in moments[:200]:
        feed(estimator, moment)
    assert estimator.advance(moments[0].joints).is_restart
    assert set(estimator.state(estimator.time).objects) == {HELD}
    for moment in moments[1:200]:
        feed(estimator, moment)
    assert max(distances(estimator.state(estimator.time), moments[199].truth).values()) < 0.002


def test_an_arm_that_is_suddenly_elsewhere_starts_over(
    estimator: PhysicsEstimator, moments: list[Moment]
) -> None:
    for moment in moments[:200]:
        feed(estimator, moment)
    elsewhere = replace(moments[200].joints, q=moments[200].joints.q + 0.3)
    assert estimator.advance(elsewhere).is_restart


def test_a_gap_in_the_joint_samples_is_bridged(estimator: PhysicsEstimator, moments: list[Moment]) -> None:
    gap = range(1100, 1100 + int(0.8 * CONFIG.max_gap * 500))
    for k, moment in enumerate(moments):
        if k not in gap:
            feed(estimator, moment, {"tea_box"} if moment.joints.time > CONTACT else None)
    assert distances(estimator.state(estimator.time), moments[-1].truth)["tea_box"] < 0.01


def test_a_gap_that_is_too_long_starts_over(estimator: PhysicsEstimator, moments: list[Moment]) -> None:
    estimator.advance(moments[0].joints)
    assert not estimator.advance(moments[10].joints).is_restart
    late = replace(moments[11].joints, time=moments[10].joints.time + 1.1 * CONFIG.max_gap)
    assert estimator.advance(late).is_restart


def test_a_frame_before_the_joints_or_ahead_of_them_changes_nothing(
    estimator: PhysicsEstimator, moments: list[Moment]
) -> None:
    frame = next(m.frames[0] for m in moments if m.frames)
    assert estimator.is_ahead(frame)
    assert estimator.correct(frame).is_unused
    estimator.advance(moments[100].joints)
    assert not estimator.is_ahead(frame)
    assert estimator.correct(frame).is_unused


def test_reading_the_state_twice_gives_the_same(estimator: PhysicsEstimator, moments: list[Moment]) -> None:
    for moment in moments[:200]:
        feed(estimator, moment)
    first, second = (estimator.state(estimator.time + 0.002) for _ in range(2))
    for name in EVERYTHING:
        assert np.array_equal(first.objects[name].X_WO.p, second.objects[name].X_WO.p)


def test_the_same_data_give_the_same_estimate(moments: list[Moment]) -> None:
    states = []
    for _ in range(2):
        estimator = PhysicsEstimator(SCENE.description(), packing_cell(), CONFIG)
        for moment in moments[:600]:
            feed(estimator, moment)
        states.append(estimator.state(estimator.time))
    for name in EVERYTHING:
        assert np.array_equal(states[0].objects[name].X_WO.p, states[1].objects[name].X_WO.p)


def test_a_scene_with_the_new_object_alone_is_estimated(moments: list[Moment]) -> None:
    alone = Scene(container=SCENE.container, friction=SCENE.friction, objects=[], new_object=SCENE.new_object)
    estimator = PhysicsEstimator(alone, packing_cell(), CONFIG)
    for moment in moments[:50]:
        estimator.advance(moment.joints)
    assert set(estimator.state(estimator.time).objects) == {HELD}
