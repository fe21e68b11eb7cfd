"""Replay of perception: the poses are estimated again, from markers or from depth images."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from pack_core.camera import PinholeCamera
from pack_core.errors import BagError
from pack_core.joints import JointSample
from pack_core.packing.cell import PackingCell, Perception
from pack_core.packing.depth import DepthFrame, FramePairing
from pack_core.packing.depth_calibration import load_depth_calibration
from pack_core.packing.markers import MarkerFrame
from pack_core.packing.scene import Scene
from pack_core.packing.seen_deviations import SEEN, SeenObjects
from pack_core.packing.topics import (
    DEPTH_IMAGES,
    DESCRIPTION,
    FILL_RESULT,
    GRIPPER_STATE,
    JOINT_STATES,
    MARKERS,
    SIM_DESCRIPTION,
)
from pack_core.ros.messages.camera import from_depth_image
from pack_core.ros.messages.conversions import from_stamp
from pack_core.ros.messages.joints import from_joint_state
from pack_core.ros.messages.packing import from_markers
from pack_core.states import SceneState
from pack_evaluation.bag import Bag, result_in
from pack_evaluation.goals import without_earlier_gaps
from pack_evaluation.packing.fill.recording import end_of
from pack_evaluation.packing.from_bag import to_run
from pack_evaluation.packing.run import Run
from pack_evaluation.track import Track, to_tracks
from pack_lockstep.packing.lockstep_config import PackingPreset
from pack_lockstep.packing.recorded_frames import SAME, check_frames
from pack_lockstep.replay import ComparisonRow, Replay
from pack_perception.depth.depth_estimator import DepthEstimator
from pack_perception.mocap.hand_over_estimator import HandOverEstimator
from pack_perception.perception_config import Objects, PerceptionConfig

TOPICS = (DESCRIPTION, JOINT_STATES, MARKERS)
PERCENT = 95
"""Percentile of the differences that decides: the rest lies in moments of contact."""
TRACK_LIMIT_MM = 1.0
"""Limit of the 95th percentile; node and core step at different joint samples, which contact magnifies."""


def replay_perception(bag: Bag, preset: PackingPreset | None = None, calibration: str = "") -> Replay:
    """Estimate the poses again and compare them with the recorded estimate during the goal or fill job.

    Args:
        bag: the recording.
        preset: preset of the run; None: config/nodes without changes.
        calibration: file of the calibration that its depth cameras had; empty: none.

    Raises:
        BagError: the recording lacks a topic or too many of its messages.
        ConfigError: the calibration cannot be read, or is of other cameras.
    """
    preset = preset or PackingPreset()
    run = to_run(bag)
    job = _job_window(bag)
    start, end = job or (run.start, run.end)
    bag = bag if job else without_earlier_gaps(bag, start, latched=(DESCRIPTION, SIM_DESCRIPTION, SEEN))
    if preset.packing_cell().perception is Perception.DEPTH:
        depth = preset.packing_cell().depth
        counts = {topic: _count_images(bag, topic) for topic in DEPTH_IMAGES[: len(depth.mounts)]}
        cameras = load_depth_calibration(Path(calibration)).applied(depth) if calibration else None
        estimated = estimate_by_depth(bag, preset, cameras)
        return Replay("perception", counts, _compare(run, start, end, estimated))
    joints = [from_stamp(message.header.stamp) for message in bag.of(JOINT_STATES)]
    frames = [from_markers(message).time for message in bag.of(MARKERS)]
    counts = {
        topic: check_frames(bag, topic, times) for topic, times in ((JOINT_STATES, joints), (MARKERS, frames))
    }
    return Replay("perception", counts, _compare(run, start, end, estimate_again(bag, preset)))


def _compare(run: Run, start: float, end: float, estimated: dict[str, Track]) -> tuple[ComparisonRow, ...]:
    return tuple(
        _compare_tracks(name, track.between(start, end), estimated.get(name))
        for name, track in run.estimate.items()
    )


def _count_images(bag: Bag, topic: str) -> int:
    """Number of a depth camera's images; none counts as missing: their rate is what the machine could do."""
    if len(images := bag.of(topic)) < 2:
        raise BagError(f"{bag.path} has {len(images)} messages on {topic}: was it recorded?")
    return len(images)


def _job_window(bag: Bag) -> tuple[float, float] | None:
    """Start and end of the last fill job [s]; None if there is none."""
    if not (results := bag.of(FILL_RESULT)):
        return None
    report = result_in(results[-1].data, bag.path)
    return float(report["start"]), end_of(report)


def estimate_again(bag: Bag, preset: PackingPreset) -> dict[str, Track]:
    """Estimated tracks by object, with a pose after every marker frame, from the messages as recorded."""
    config, cell = preset.parameters("perception", PerceptionConfig), preset.packing_cell()
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


def estimate_by_depth(
    bag: Bag, preset: PackingPreset, cameras: Sequence[PinholeCamera] | None = None
) -> dict[str, Track]:
    """Estimated tracks by object, with a pose after every joint state that is used, and after every frame.

    The cameras hang where a calibration has found them, or else where described. It looks at the images that
    were looked at, as others give other sizes; what was seen in none that was recorded counts as described.
    """
    config, cell = preset.parameters("perception", PerceptionConfig), preset.packing_cell()
    estimator: DepthEstimator | None = None
    pairing = FramePairing(len(cell.depth.mounts))
    waiting: deque[DepthFrame] = deque()
    states: list[SceneState] = []
    has_looked = is_handed_over = False
    looks = [SeenObjects.from_yaml(message.data).time for message in bag.of(SEEN)]
    for item in bag.messages:
        if item.topic == SIM_DESCRIPTION:
            scene = Scene.from_yaml(item.message.data, SIM_DESCRIPTION)
            is_handed_over = scene.is_handed_over
            waiting.clear()
            if is_handed_over and estimator is not None:
                estimator.change_scene(scene)
            else:
                estimator, has_looked = DepthEstimator(scene, cell, config, cameras), False
        elif item.topic == GRIPPER_STATE and estimator is not None and is_handed_over:
            _grip(estimator, is_closed=item.message.is_closed)
        elif item.topic == DESCRIPTION and not has_looked:
            scene = Scene.from_yaml(item.message.data, DESCRIPTION)
            estimator = DepthEstimator(scene, cell, _as_described(config), cameras)
        elif item.topic == JOINT_STATES and estimator is not None:
            _advance(estimator, from_joint_state(item.message, cell.robot.arm.joints))
            if estimator.knows_objects:
                states.append(estimator.state(estimator.time))
        elif item.topic in DEPTH_IMAGES:
            waiting.extend(_frames(pairing, cell, item.topic, item.message))
        if estimator is not None and (used := _use_frames(estimator, waiting, looks)):
            has_looked = True
            states += used
    return to_tracks(states)


def _use_frames(
    estimator: DepthEstimator, waiting: deque[DepthFrame], looks: Sequence[float]
) -> list[SceneState]:
    """The states after each frame that joint states have come for; `looks` are times of looks [s]."""
    states = []
    while waiting and not estimator.is_ahead(waiting[0]):
        frame = waiting.popleft()
        next_look = min((look for look in looks if look > frame.time - SAME), default=frame.time)
        if estimator.needs_look and frame.time < next_look - SAME:
            continue  # the node began later, or was busy
        estimator.see(frame)
        states.append(estimator.state(estimator.time))
    return states


def _frames(pairing: FramePairing, cell: PackingCell, topic: str, message: Any) -> list[DepthFrame]:
    """The frame that an image completes, if it does."""
    number = DEPTH_IMAGES.index(topic)
    image = from_depth_image(message, cell.depth.cameras()[number])
    frame = pairing.add(number, from_stamp(message.header.stamp), image)
    return [] if frame is None else [frame]


def _as_described(config: PerceptionConfig) -> PerceptionConfig:
    depth = config.depth.model_copy(update={"objects": Objects.DESCRIBED})
    return config.model_copy(update={"depth": depth})


def _grip(estimator: HandOverEstimator, *, is_closed: bool) -> None:
    """Follow the pump, as the node does."""
    if is_closed and not estimator.is_held:
        estimator.take_hold()
    elif not is_closed and estimator.is_held:
        estimator.let_go()


def _advance(estimator: HandOverEstimator, joints: JointSample) -> None:
    if estimator.wants(joints.time):
        estimator.advance(joints)


def _compare_tracks(name: str, recorded: Track, again: Track | None) -> ComparisonRow:
    if again is None or not recorded.times.size:
        return ComparisonRow(name, 0, float("nan"), float("nan"), TRACK_LIMIT_MM)
    errors = 1e3 * again.at(recorded.times).distance_to(recorded.p)
    worst = float(np.percentile(errors, PERCENT))
    return ComparisonRow(name, errors.size, float(errors.mean()), worst, TRACK_LIMIT_MM)
