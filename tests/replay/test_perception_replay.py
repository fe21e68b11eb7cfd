from collections import deque

import numpy as np
import pytest

from pack_bringup.node_parameters import load_parameters
from pack_core.cells.packing import packing_cell
from pack_core.evaluation.track import Track
from pack_core.ros.contracts import packing as contracts
from pack_core.ros.conversions import from_joint_state, from_markers
from pack_core.scene.state import MarkerFrame, SceneState
from pack_perception.mocap.physics_estimator import EstimatorConfig, PhysicsEstimator
from replay.sample import COUNTS, sample, sample_run, sample_scene


@pytest.fixture(scope="module")
def replayed() -> dict[str, Track]:
    """The estimate after every marker frame, by object."""
    config = load_parameters("perception", EstimatorConfig)
    estimator = PhysicsEstimator(sample_scene(), packing_cell(), config)
    frames: deque[MarkerFrame] = deque()
    states: list[SceneState] = []
    for item in sample().messages:
        if item.topic == contracts.JOINT_STATES.name:
            joints = from_joint_state(item.message)
            if estimator.wants(joints.time):
                estimator.advance(joints)
        elif item.topic == contracts.MARKERS.name:
            frames.append(from_markers(item.message))
        while frames and not estimator.is_ahead(frames[0]):
            estimator.correct(frames.popleft())
            states.append(estimator.state(estimator.time))
    return {name: _track(name, states) for name in states[-1].objects}


def _track(name: str, states: list[SceneState]) -> Track:
    seen = [(state.time, state.objects[name]) for state in states if name in state.objects]
    return Track(
        times=np.array([time for time, _ in seen]),
        p=np.array([item.X_WO.p for _, item in seen]), q=np.array([item.X_WO.q for _, item in seen]),
        sources=np.array([item.source for _, item in seen], dtype=np.uint8),
    )  # fmt: skip


def test_the_sample_holds_every_frame() -> None:
    counts = sample().counts()
    assert {topic: counts[topic] for topic in COUNTS} == COUNTS


def test_the_core_estimates_what_the_node_published(replayed: dict[str, Track]) -> None:
    """Up to which joint samples each of them took a step on, which contact magnifies."""
    run = sample_run()
    assert replayed.keys() == run.estimate.keys()
    for name, track in replayed.items():
        window = run.estimate[name].between(run.start, run.end)
        assert len(window.times) > 100 * (run.end - run.start)
        errors = track.at(window.times).distance_to(window.p)
        assert np.percentile(errors, 95) < 1e-3, name
        assert np.mean(errors) < 3e-4, name


def test_the_replayed_estimate_stays_close_to_the_truth(replayed: dict[str, Track]) -> None:
    for name, track in replayed.items():
        errors = track.distance_to(sample_run().truth[name].at(track.times).p)
        assert np.max(errors) < 5e-3, name
        assert np.mean(errors) < 1e-3, name
