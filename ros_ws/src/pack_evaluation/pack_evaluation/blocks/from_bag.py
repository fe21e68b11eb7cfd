"""A recording of the blocks cell as arrays."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from pack_core.blocks.plan import Action, PickPlace, Plan, PlanStatus, Push
from pack_core.blocks.planar import PlanarPose
from pack_core.blocks.problem import Problem
from pack_core.blocks.problem_file import load_problem, parse_problem
from pack_core.blocks.topics import BLOCK_POSES, JAW_STATE, RESULT, STATUS, TRUTH
from pack_core.errors import BagError
from pack_core.motion.topics import JOINT_STATES
from pack_core.rotations import Array, Pose
from pack_evaluation.bag import fitting, read_bag, result_in, seconds, times_of
from pack_evaluation.goals import RecordedRun, goal_of
from pack_evaluation.track import Track, recorded_tracks

TOPICS = (TRUTH, JOINT_STATES, JAW_STATE, BLOCK_POSES, STATUS, RESULT)
FIELDS = (
    "success", "exit_reason", "message", "execution_time", "picks", "pushes", "plans", "failed_grasps",
    "refusals", "deviations", "disturbances",
)  # fmt: skip
"""Fields that the action's result must have."""
PUSH = 2
"""BlockAction's kind of a push."""
PROBLEM_FILE = "problem.yaml"


@dataclass(frozen=True)
class Sight:
    """Detections in one picture: time of exposure [s], X_WB by id, and ids not seen or seen twice."""

    time: float
    poses: Mapping[str, PlanarPose]
    unclear: tuple[str, ...]


@dataclass(frozen=True)
class BlocksRun(RecordedRun):
    """One recorded rearrangement.

    Attributes:
        problem: start and goal poses of the blocks.
        result: the fields of the action's result.
        plans: every plan that was made, in order.
        sights: detections in every picture.
        start: when the goal's first true pose was recorded [s].
        end: when its last one was [s].
        truth: true poses of the blocks by id.
        joint_times: times of the joint positions `(J,)` [s].
        joints: measured joint positions `(J, 6)` [rad].
        jaw_times: times of the openings `(G,)` [s].
        openings: distances between the gripper's pads `(G,)` [m].
    """

    problem: Problem
    result: Mapping[str, Any]
    plans: tuple[Plan, ...]
    sights: tuple[Sight, ...]
    start: float
    end: float
    truth: Mapping[str, Track]
    joint_times: Array
    joints: Array
    jaw_times: Array
    openings: Array

    def poses_at(self, time: float) -> dict[str, PlanarPose]:
        """True X_WB by id at `time` [s], or at the nearest time that was recorded."""
        return {
            name: planar(track.pose(int(np.abs(track.times - time).argmin())))
            for name, track in self.truth.items()
        }


def load_blocks_run(path: Path, goal: int | None = None) -> BlocksRun:
    """Read a recorded rearrangement.

    Args:
        path: a run's folder, or its bag's.
        goal: which rearrangement of a recording with several, from 1; None: the last.

    Raises:
        BagError: the recording is missing, broken, of another version, or holds no rearrangement.
        ConfigError: there is no problem file beside it.
    """
    with fitting(path):
        return _blocks_run(path, goal)


def _blocks_run(path: Path, goal: int | None) -> BlocksRun:
    bag, number = goal_of(
        read_bag(path, TOPICS), goal, result=RESULT,
        needed=(TRUTH, JOINT_STATES, JAW_STATE, STATUS, RESULT),
        has_begun=lambda rest: any(item.topic == STATUS for item in rest),
    )  # fmt: skip
    result = read_result(bag.of(RESULT)[-1].data, bag.path)
    truth, joints, jaw = bag.of(TRUTH), bag.of(JOINT_STATES), bag.of(JAW_STATE)
    times, problem = times_of(truth), problem_of(result, path)
    tracks = recorded_tracks(truth)
    if missing := sorted(problem.goals.keys() - tracks.keys()):
        raise BagError(f"{bag.path}: blocks of the goal were not in the cell: {', '.join(missing)}")
    return BlocksRun(
        problem=problem, result=result,
        plans=tuple(_plans(bag.of(STATUS))), sights=tuple(_sight(message) for message in bag.of(BLOCK_POSES)),
        start=float(times[0]), end=float(times[-1]), truth=tracks,
        joint_times=times_of(joints), joints=np.array([message.position for message in joints]),
        jaw_times=times_of(jaw),
        openings=np.array([message.opening for message in jaw]), is_cut=bag.is_cut,
        damaged=bag.damaged, notes=bag.notes, goal=number,
    )  # fmt: skip


def read_result(text: str, path: Path) -> dict[str, Any]:
    """The fields of the action's result.

    Args:
        text: the result as JSON.
        path: path of the bag, for the error.

    Raises:
        BagError: a field is missing.
    """
    result = result_in(text, path)
    if missing := [name for name in FIELDS if name not in result]:
        raise BagError(f"{path}: the result lacks {', '.join(missing)}; another version recorded it")
    return result


def problem_of(result: Mapping[str, Any], path: Path) -> Problem:
    """The problem that a goal was given: in its result, or of older recordings in a file beside the bag.

    Raises:
        ConfigError: it is in neither, or not as a problem should be.
    """
    if text := result.get("problem"):
        return parse_problem(text, str(path), goals_only=True)
    folder = path if (path / PROBLEM_FILE).is_file() else path.parent
    return load_problem(folder / PROBLEM_FILE)


def planar(X_WB: Pose) -> PlanarPose:
    """The pose as far as it lies in the table's plane."""
    w, x, y, z = X_WB.q
    yaw = np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
    return PlanarPose(float(X_WB.p[0]), float(X_WB.p[1]), float(yaw))


def _plans(messages: Sequence[Any]) -> list[Plan]:
    """The plans with at least one action, in the order in which the executor requested them."""
    plans: dict[int, Plan] = {}
    for message in messages:
        if message.plan:
            actions = tuple(_action(item) for item in message.plan)
            plans.setdefault(message.plans, Plan(PlanStatus.FEASIBLE, actions, message.lower_bound))
    return list(plans.values())


def _action(message: Any) -> Action:
    start, end = (PlanarPose(pose.x, pose.y, pose.yaw) for pose in (message.start, message.end))
    if message.kind == PUSH:
        return Push(message.start.id, start, end)
    return PickPlace(message.start.id, start, end, message.grasp)


def _sight(message: Any) -> Sight:
    poses = {item.id: PlanarPose(item.x, item.y, item.yaw) for item in message.blocks}
    return Sight(seconds(message.header.stamp), poses, (*message.missing, *message.doubled))
