"""A goal plans only from scenes that have every object that it knows to be there."""

from dataclasses import replace

import numpy as np
import pytest

from pack_core.errors import MessageError
from pack_core.joints import JointSample
from pack_core.packing.cell import packing_cell
from pack_core.packing.goals import PackingMethod
from pack_core.packing.scene import Scene
from pack_core.states import SceneState
from pack_mpc.observation import PackingObservation
from pack_mpc.session import PackingSession, SessionConfig

LATENCY = 0.048
LOST = "soup_can"


@pytest.fixture
def session(scene: Scene) -> PackingSession:
    return PackingSession(scene, packing_cell(), SessionConfig(), PackingMethod.PACK_IT_IN, 0.0)


def seen(joints: JointSample, state: SceneState, *lost: str) -> PackingObservation:
    objects = {name: pose for name, pose in state.objects.items() if name not in lost}
    return PackingObservation(joints, replace(state, objects=objects), np.zeros((1, 3)))


def test_an_object_that_the_scene_has_lost_holds_the_goal_until_it_is_back(
    session: PackingSession, joints: JointSample, state: SceneState
) -> None:
    assert session.step(seen(joints, state), LATENCY) is not None
    with pytest.raises(MessageError, match=f"lacks {LOST}"):
        session.step(seen(joints, state, LOST), LATENCY)
    assert session.task.outcome is None
    assert session.step(seen(joints, state), LATENCY) is not None


def test_an_object_that_was_never_seen_is_looked_for(
    session: PackingSession, joints: JointSample, state: SceneState
) -> None:
    assert session.step(seen(joints, state, LOST), LATENCY) is not None
    assert not session.needs_placement(seen(joints, state, LOST).scene)


def test_without_the_held_object_nothing_is_planned(
    session: PackingSession, scene: Scene, joints: JointSample, state: SceneState
) -> None:
    held = scene.new_object.name
    with pytest.raises(MessageError, match=f"lacks {held}"):
        session.step(seen(joints, state, held), LATENCY)


def test_an_object_that_is_seen_meanwhile_is_taken_up_without_a_stop(
    scene: Scene, joints: JointSample, state: SceneState
) -> None:
    others = [item for item in scene.objects if item.name != LOST]
    session = PackingSession(
        scene.model_copy(update={"objects": others}), packing_cell(), SessionConfig(),
        PackingMethod.PACK_IT_IN, 0.0,
    )  # fmt: skip
    before = session.step(seen(joints, state, LOST), LATENCY)
    assert session.follow(scene)
    assert not session.follow(scene)
    with pytest.raises(MessageError, match=f"lacks {LOST}"):
        session.step(seen(joints, state, LOST), LATENCY)
    after = session.step(seen(joints, state), LATENCY)
    assert before is not None
    assert after is not None
    # it goes on along the plan before
    q, _, _ = before.setpoints.at(after.setpoints.time)
    assert after.setpoints.q[0] == pytest.approx(q, abs=0.01)


def test_a_container_that_is_found_to_stand_elsewhere_is_taken_up(
    session: PackingSession, scene: Scene
) -> None:
    moved = scene.container.model_copy(update={"centre": (0.51, 0.003)})
    assert session.follow(scene.model_copy(update={"container": moved}))
    assert session.scene.container == session.controller.scene.container == moved
    assert not session.follow(scene.model_copy(update={"container": moved}))


def test_what_is_described_for_another_goal_is_not_taken_up(session: PackingSession, scene: Scene) -> None:
    other = scene.new_object.model_copy(update={"name": "other"})
    assert not session.follow(scene.model_copy(update={"new_object": other}))
    assert not session.follow(scene.model_copy(update={"objects": scene.objects[:-1]}))
    assert session.scene is scene
