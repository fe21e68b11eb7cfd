"""Replays recorded joints and markers through the physics estimator."""

from __future__ import annotations

from collections import deque

import numpy as np

from pack_core.joints import JointSample
from pack_core.packing.markers import MarkerFrame
from pack_core.packing.scene import Scene
from pack_core.packing.topics import DESCRIPTION, JOINT_STATES, MARKERS
from pack_core.ros.conversions import from_stamp
from pack_core.ros.joint_messages import from_joint_state
from pack_core.ros.packing.marker_messages import from_markers
from pack_core.states import SceneState
from pack_evaluation.bag import Bag
from pack_evaluation.goals import without_earlier_gaps
from pack_evaluation.packing.from_bag import to_run
from pack_evaluation.track import Track, to_tracks
from pack_lockstep.packing.presets import PackingPreset
from pack_lockstep.packing.replay.comparison import ComparisonRow, Replay, check_frames
from pack_perception.mocap.estimator_config import EstimatorConfig
from pack_perception.mocap.physics_estimator import PhysicsEstimator

TOPICS = (DESCRIPTION, JOINT_STATES, MARKERS)
PERCENT = 95
LIMIT_MM = 1.0
"""Limit of the 95th percentile; node and core step at different joint samples, which contact magnifies."""


def replay_perception(bag: Bag, preset: PackingPreset | None = None) -> Replay:
    """Estimate the poses again and compare them with the recorded estimate during the goal.

    Args:
        bag: the recording.
        preset: preset of the run; None: config/nodes without changes.

    Raises:
        BagError: the recording lacks a topic or too many of its messages.
    """
    run = to_run(bag)
    bag = without_earlier_gaps(bag, run.start, latched=(DESCRIPTION,))
    joints = [from_stamp(message.header.stamp) for message in bag.of(JOINT_STATES)]
    frames = [from_markers(message).time for message in bag.of(MARKERS)]
    counts = {
        topic: check_frames(bag, topic, times) for topic, times in ((JOINT_STATES, joints), (MARKERS, frames))
    }
    estimated = estimate_again(bag, preset or PackingPreset())
    rows = tuple(
        _compare(name, track.between(run.start, run.end), estimated.get(name))
        for name, track in run.estimate.items()
    )
    return Replay("perception", counts, rows)


def estimate_again(bag: Bag, preset: PackingPreset) -> dict[str, Track]:
    """Estimated tracks by object, with a pose after every marker frame, from the messages as recorded."""
    scene = Scene.from_yaml(bag.of(DESCRIPTION)[-1].data, DESCRIPTION)
    config = preset.parameters("perception", EstimatorConfig)
    cell = preset.packing_cell()
    estimator = PhysicsEstimator(scene, cell, config)
    waiting: deque[MarkerFrame] = deque()
    states: list[SceneState] = []
    for item in bag.messages:
        if item.topic == JOINT_STATES:
            _advance(estimator, from_joint_state(item.message, cell.robot.arm.joints))
        elif item.topic == MARKERS:
            waiting.append(from_markers(item.message))
        while waiting and not estimator.is_ahead(waiting[0]):
            estimator.correct(waiting.popleft())
            states.append(estimator.state(estimator.time))
    return to_tracks(states)


def _advance(estimator: PhysicsEstimator, joints: JointSample) -> None:
    if estimator.wants(joints.time):
        estimator.advance(joints)


def _compare(name: str, recorded: Track, again: Track | None) -> ComparisonRow:
    if again is None or not recorded.times.size:
        return ComparisonRow(name, 0, float("nan"), float("nan"), LIMIT_MM)
    errors = 1e3 * again.at(recorded.times).distance_to(recorded.p)
    worst = float(np.percentile(errors, PERCENT))
    return ComparisonRow(name, errors.size, float(errors.mean()), worst, LIMIT_MM)
