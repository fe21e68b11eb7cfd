"""Replays recorded joints and markers through the physics estimator."""

from __future__ import annotations

from collections import deque

import numpy as np

from pack_core.joints import JointSample
from pack_core.packing.markers import MarkerFrame
from pack_core.packing.scene import Scene
from pack_core.packing.topics import DESCRIPTION, FILL_RESULT, GRIPPER_STATE, JOINT_STATES, MARKERS
from pack_core.ros.messages.conversions import from_stamp
from pack_core.ros.messages.joints import from_joint_state
from pack_core.ros.messages.packing import from_markers
from pack_core.states import SceneState
from pack_evaluation.bag import Bag, result_in
from pack_evaluation.goals import without_earlier_gaps
from pack_evaluation.packing.from_bag import to_run
from pack_evaluation.track import Track, to_tracks
from pack_lockstep.packing.presets import PackingPreset
from pack_lockstep.packing.replay.comparison import ComparisonRow, Replay, check_frames
from pack_perception.mocap.hand_over_estimator import HandOverEstimator
from pack_perception.mocap.physics_estimator import EstimatorConfig

TOPICS = (DESCRIPTION, JOINT_STATES, MARKERS)
PERCENT = 95
LIMIT_MM = 1.0
"""Limit of the 95th percentile; node and core step at different joint samples, which contact magnifies."""


def replay_perception(bag: Bag, preset: PackingPreset | None = None) -> Replay:
    """Estimate the poses again and compare them with the recorded estimate during the goal or fill job.

    Args:
        bag: the recording.
        preset: preset of the run; None: config/nodes without changes.

    Raises:
        BagError: the recording lacks a topic or too many of its messages.
    """
    run = to_run(bag)
    job = _job_window(bag)
    start, end = job or (run.start, run.end)
    bag = bag if job else without_earlier_gaps(bag, start, latched=(DESCRIPTION,))
    joints = [from_stamp(message.header.stamp) for message in bag.of(JOINT_STATES)]
    frames = [from_markers(message).time for message in bag.of(MARKERS)]
    counts = {
        topic: check_frames(bag, topic, times) for topic, times in ((JOINT_STATES, joints), (MARKERS, frames))
    }
    estimated = estimate_again(bag, preset or PackingPreset())
    rows = tuple(
        _compare(name, track.between(start, end), estimated.get(name)) for name, track in run.estimate.items()
    )
    return Replay("perception", counts, rows)


def _job_window(bag: Bag) -> tuple[float, float] | None:
    """Start and end of the last fill job [s]; None if there is none."""
    if not (told := bag.of(FILL_RESULT)):
        return None
    report = result_in(told[-1].data, bag.path)
    return float(report["start"]), float(report["fills"][-1][0])


def estimate_again(bag: Bag, preset: PackingPreset) -> dict[str, Track]:
    """Estimated tracks by object, with a pose after every marker frame, from the messages as recorded."""
    config, cell = preset.parameters("perception", EstimatorConfig), preset.packing_cell()
    scene, *changes = [Scene.from_yaml(message.data, DESCRIPTION) for message in bag.of(DESCRIPTION)]
    estimator = HandOverEstimator(scene, cell, config)
    later = iter([None, *changes])  # the first is known before anything else comes
    waiting: deque[MarkerFrame] = deque()
    states: list[SceneState] = []
    for item in bag.messages:
        if item.topic == JOINT_STATES:
            _advance(estimator, from_joint_state(item.message, cell.robot.arm.joints))
        elif item.topic == MARKERS:
            waiting.append(from_markers(item.message))
        elif item.topic == GRIPPER_STATE and scene.is_handed_over:
            _grip(estimator, is_closed=item.message.is_closed)
        elif item.topic == DESCRIPTION and (change := next(later)) is not None:
            scene = change
            waiting.clear()
            if scene.is_handed_over:
                estimator.change_scene(scene)
            else:
                estimator = HandOverEstimator(scene, cell, config)
        while waiting and not estimator.is_ahead(waiting[0]):
            estimator.correct(waiting.popleft())
            states.append(estimator.state(estimator.time))
    return to_tracks(states)


def _grip(estimator: HandOverEstimator, *, is_closed: bool) -> None:
    """Follow the pump, as the node does."""
    if is_closed and not estimator.is_held:
        estimator.take_hold()
    elif not is_closed and estimator.is_held:
        estimator.let_go()


def _advance(estimator: HandOverEstimator, joints: JointSample) -> None:
    if estimator.wants(joints.time):
        estimator.advance(joints)


def _compare(name: str, recorded: Track, again: Track | None) -> ComparisonRow:
    if again is None or not recorded.times.size:
        return ComparisonRow(name, 0, float("nan"), float("nan"), LIMIT_MM)
    errors = 1e3 * again.at(recorded.times).distance_to(recorded.p)
    worst = float(np.percentile(errors, PERCENT))
    return ComparisonRow(name, errors.size, float(errors.mean()), worst, LIMIT_MM)
