"""A recording of the packing cell as arrays."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from pack_core import stamps
from pack_core.errors import BagError, MessageError
from pack_core.packing.scene import Scene
from pack_core.packing.seen_deviations import SEEN, SeenDeviations, SeenObjects
from pack_core.packing.settled_sample import SettledSample
from pack_core.packing.topics import (
    DEPTH_INFOS,
    DESCRIPTION,
    GRIPPER_STATE,
    JOINT_STATES,
    MPC_STATUS,
    RESULT,
    SCENE,
    SETTLED_SAMPLES,
    SIM_DESCRIPTION,
    TRUTH,
    WRENCH,
)
from pack_core.robots.packing_arms import arm_of
from pack_core.rotations import Array, Pose
from pack_core.topics import REAL_TIME_FACTOR
from pack_evaluation.bag import Bag, Recorded, fitting, read_bag, result_in, seconds, times_of
from pack_evaluation.goals import goal_of
from pack_evaluation.packing.run import Iterations, Run, SeenScene
from pack_evaluation.packing.run_file import SUFFIX, load_saved_run
from pack_evaluation.packing.seen_objects import seen_objects, with_true_names
from pack_evaluation.track import orientation, position, recorded_tracks

TOPICS = (
    DESCRIPTION, MPC_STATUS, RESULT, TRUTH, SCENE, JOINT_STATES, WRENCH, GRIPPER_STATE, REAL_TIME_FACTOR,
    SETTLED_SAMPLES, SIM_DESCRIPTION, DEPTH_INFOS[0], SEEN,
)  # fmt: skip


def load_run(path: Path, goal: int | None = None) -> Run:
    """Read a goal of a run.

    Args:
        path: a run's folder, a bag's folder or an MCAP file, or a run that a benchmark saved (.npz).
        goal: which goal of a recording with several, from 1; None: the last.

    Raises:
        BagError: the recording is missing, broken, or holds no goal.
    """
    if path.suffix == SUFFIX:
        return load_saved_run(path)
    with fitting(path):
        return named_as_true(*_goal_in(read_bag(path, TOPICS), goal))


def to_run(bag: Bag, goal: int | None = None) -> Run:
    """A goal in a bag, by its number from 1; the last if None. Objects have the names that perception gave.

    Raises:
        BagError: a topic that every run has is missing, or there is no such goal.
    """
    return _goal_in(bag, goal)[0]


def named_as_true(run: Run, bag: Bag) -> Run:
    """A bag's run with what depth cameras saw, under the true objects' names; as it is with markers."""
    if not bag.of(DEPTH_INFOS[0]) or not bag.of(SIM_DESCRIPTION):
        return run
    told = Scene.from_yaml(bag.of(SIM_DESCRIPTION)[-1].data, SIM_DESCRIPTION)
    looks = [SeenObjects.from_yaml(message.data) for message in bag.of(SEEN)]
    before = next((look.objects for look in reversed(looks) if look.time <= run.start), {})
    after = looks[-1].objects if looks else {}
    last = Scene.from_yaml(bag.of(DESCRIPTION)[-1].data, DESCRIPTION)
    seen_after = _seen_at(run, run.end, last, told, after)
    named = with_true_names(run, _seen_at(run, run.start, run.scene, told, before), told)
    return replace(named, seen_after=seen_after)


def _seen_at(
    run: Run, time: float, known: Scene, true: Scene, deviations: Mapping[str, SeenDeviations]
) -> SeenScene:
    """What perception knew at a time [s], matched to what was there."""
    moment = np.array([time])
    estimate, truth = (
        {name: track.at(moment).pose(0) for name, track in tracks.items()}
        for tracks in (run.estimate, run.truth)
    )
    return seen_objects(known, estimate, true, truth, deviations)


def _described(bag: Bag, start: float) -> Scene:
    """The cell as described when a goal began, at `start` [s]; depth cameras see more while it runs."""
    told = [item for item in bag.messages if item.topic == DESCRIPTION]
    before = [item for item in told if stamps.to_seconds(item.time_ns) <= start]
    return Scene.from_yaml((before[-1] if before else told[0]).message.data, DESCRIPTION)


def _goal_in(bag: Bag, goal: int | None) -> tuple[Run, Bag]:
    """A goal, and the part of the bag that it is in."""
    bag, number = goal_of(
        bag, goal, result=RESULT, needed=(DESCRIPTION, TRUTH, SCENE, JOINT_STATES, WRENCH),
        latched=(DESCRIPTION, SIM_DESCRIPTION, DEPTH_INFOS[0], SEEN, SETTLED_SAMPLES), has_begun=_has_begun,
    )  # fmt: skip
    if not bag.of(MPC_STATUS) and not bag.of(RESULT):
        raise BagError(f"{bag.path} has no message on {MPC_STATUS} or {RESULT}: was a goal sent?")
    iterations, outcome = _last_goal(bag)
    start, end = _window(bag, iterations, outcome)
    joints, wrenches = bag.of(JOINT_STATES), bag.of(WRENCH)
    run = Run(
        scene=_described(bag, start), start=start, end=end,
        iterations=iterations, truth=recorded_tracks(bag.of(TRUTH)), estimate=recorded_tracks(bag.of(SCENE)),
        joint_times=times_of(joints), joints=np.array([message.position for message in joints]),
        force_times=times_of(wrenches), force=magnitudes(wrenches),
        release_reason=_release(bag, start),
        real_time_factors=_real_time_factors(bag, start, end),
        outcome=outcome, is_cut=bag.is_cut, damaged=bag.damaged, notes=bag.notes, arm=_arm(bag, joints[0]),
        samples=_samples(bag, start), goal=number,
    )  # fmt: skip
    return run, bag


def _has_begun(rest: Sequence[Recorded]) -> bool:
    """Whether the controller worked on a goal after the last result: one late status may still follow it."""
    return sum(item.topic == MPC_STATUS for item in rest) > 1


def _window(bag: Bag, iterations: Iterations, outcome: dict[str, Any]) -> tuple[float, float]:
    if iterations.times.size:
        start, end = iterations.times[0] - iterations.elapsed[0], iterations.times[-1]
        return float(start), float(start + outcome["execution_time"] if outcome else end)
    end = stamps.to_seconds([item.time_ns for item in bag.messages if item.topic == RESULT][-1])
    return end - float(outcome["execution_time"]), end


def _arm(bag: Bag, joints: Any) -> str:
    """Name of the arm whose joints a message lists."""
    try:
        return arm_of(joints.name).name
    except MessageError as error:
        raise BagError(f"{bag.path}: {error}") from error


def _last_goal(bag: Bag) -> tuple[Iterations, dict[str, Any]]:
    """Iterations and result of the last goal; the result is empty if only an earlier goal has one."""
    status = [item for item in bag.messages if item.topic == MPC_STATUS]
    results = [item for item in bag.messages if item.topic == RESULT]
    elapsed = np.array([item.message.elapsed for item in status])
    # the time since the goal was accepted falls only where a new goal begins
    restarts = np.flatnonzero(np.diff(elapsed) < 0.0)
    last = status[restarts[-1] + 1 :] if restarts.size else status
    is_newer = bool(results) and (not last or results[-1].time_ns >= last[-1].time_ns)
    outcome = result_in(results[-1].message.data, bag.path) if is_newer else {}
    return _iterations([item.message for item in last]), outcome


def _iterations(last: Sequence[Any]) -> Iterations:
    columns = ("elapsed", "distance", "cost", "iteration_ms", "placements")
    elapsed, distance, cost, ms, placements = (
        np.array([getattr(message, name) for message in last], dtype=float) for name in columns
    )
    return Iterations(
        times=times_of(last), elapsed=elapsed, stages=tuple(message.stage for message in last),
        distance=distance, cost=cost, ms=ms, placements=placements,
        p_WT=np.array([position(message.target) for message in last]).reshape(-1, 3),
        q_WT=np.array([orientation(message.target) for message in last]).reshape(-1, 4),
        collisions=tuple(tuple(message.collisions) for message in last),
    )  # fmt: skip


def magnitudes(wrenches: Sequence[Any]) -> Array:
    """Magnitude of the force of each recorded wrench `(n,)` [N]."""
    forces = [message.wrench.force for message in wrenches]
    return np.asarray(np.linalg.norm([(force.x, force.y, force.z) for force in forces], axis=-1))


def _real_time_factors(bag: Bag, start: float, end: float) -> Array:
    first, last = stamps.to_ns(start), stamps.to_ns(end)
    reports = [item for item in bag.messages if item.topic == REAL_TIME_FACTOR]
    return np.array([item.message.data for item in reports if first <= item.time_ns <= last])


def _samples(bag: Bag, start: float) -> tuple[SettledSample, ...]:
    """The settled samples of the first placement after `start` [s]."""
    first = stamps.to_ns(start)
    later = (item for item in bag.messages if item.topic == SETTLED_SAMPLES and item.time_ns >= first)
    message = next(later, None)
    return tuple(_sample(sample) for sample in message.message.samples) if message else ()


def _sample(message: Any) -> SettledSample:
    poses = [Pose(np.array(position(pose)), np.array(orientation(pose))) for pose in message.poses]
    by_name = dict(zip(message.names, poses, strict=True))
    return SettledSample(message.cost, message.rank, message.is_feasible, by_name)


def _release(bag: Bag, start: float) -> str:
    reasons = [
        message.release_reason for message in bag.of(GRIPPER_STATE) if seconds(message.header.stamp) >= start
    ]
    return next((reason for reason in reasons if reason), "")
