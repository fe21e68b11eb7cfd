"""A recorded fill job: its report as the node published it, and the cell over its time, for pictures."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from pack_core import stamps
from pack_core.errors import BagError
from pack_core.packing.objects import ObjectModel
from pack_core.packing.parking import parked_pose
from pack_core.packing.scene import Scene
from pack_core.packing.topics import DESCRIPTION, FILL_RESULT, JOINT_STATES, TRUTH, WRENCH
from pack_core.robots.packing_arms import arm_of
from pack_core.rotations import Array
from pack_evaluation.bag import fitting, read_bag, result_in
from pack_evaluation.goals import ONLY_GOAL, GoalNumber
from pack_evaluation.packing.run import Iterations, Run
from pack_evaluation.raw_bag import read_raw_bag
from pack_evaluation.track import Track

TOPICS = (DESCRIPTION, FILL_RESULT, TRUTH, JOINT_STATES, WRENCH)
INSTANT = 1e-3
"""Time in which an object comes from where it is parked to where it is handed over, in pictures [s]."""


@dataclass(frozen=True)
class FillRun:
    """A fill job of a recording.

    Attributes:
        run: the cell over the job's time, with all objects that were ever in it.
        report: fields of `/fill_container/result`.
    """

    run: Run
    report: Mapping[str, Any]

    @property
    def is_cut(self) -> bool:
        """Whether the recording was cut off."""
        return self.run.is_cut

    @property
    def damaged(self) -> int:
        """Number of pieces of the recording that could not be read."""
        return self.run.damaged

    @property
    def goal(self) -> GoalNumber:
        """The last job of the recording."""
        return ONLY_GOAL


def has_fill_job(path: Path) -> bool:
    """Whether a recording holds the result of a fill job."""
    is_bag = path.is_dir() or path.suffix == ".mcap"
    return is_bag and bool(read_raw_bag(path, (FILL_RESULT,)).messages)


def load_fill_run(path: Path) -> FillRun:
    """The last fill job of a recording.

    Raises:
        BagError: the recording is missing, broken, or holds none.
    """
    bag = read_bag(path, TOPICS)
    if missing := [topic for topic in TOPICS if not bag.of(topic)]:
        raise BagError(f"{bag.path} has no message on {', '.join(missing)}")
    with fitting(path):
        report = result_in(bag.of(FILL_RESULT)[-1].data, path)
        scene = _all_objects([Scene.from_yaml(m.data, DESCRIPTION) for m in bag.of(DESCRIPTION)])
        joints, wrenches = bag.of(JOINT_STATES), bag.of(WRENCH)
        times = _times(joints)
        forces = [message.wrench.force for message in wrenches]
        start, end = float(report["start"]), float(report["fills"][-1][0])
        run = Run(
            scene=scene, start=start, end=end, iterations=_none(), truth=_tracks(bag.of(TRUTH), scene, times),
            estimate={}, joint_times=times, joints=np.array([message.position for message in joints]),
            force_times=_times(wrenches), force=np.array([np.hypot(np.hypot(f.x, f.y), f.z) for f in forces]),
            release_reason="", real_time_factors=np.zeros(0), outcome=dict(report), is_cut=bag.is_cut,
            damaged=bag.damaged, arm=arm_of(joints[0].name).name,
        )  # fmt: skip
    return FillRun(run, report)


def _all_objects(descriptions: Sequence[Scene]) -> Scene:
    """The last description, with every object that any of them has from the first handed over on."""
    items: dict[str, ObjectModel] = {}
    for scene in descriptions:
        if scene.is_handed_over:
            for item in (*scene.objects, scene.new_object):
                items[item.name] = item.model_copy(update={"pose": None})
    *objects, new = items.values()
    return descriptions[-1].model_copy(update={"objects": objects, "new_object": new, "grip": None})


def _tracks(messages: Sequence[Any], scene: Scene, times: Array) -> dict[str, Track]:
    """Paths of all objects over the whole time, parked while they are not in the cell."""
    samples: dict[str, list[tuple[float, list[float], list[float]]]] = {
        name: [] for name in (*scene.names, scene.new_object.name)
    }
    for message in messages:
        time = _seconds(message)
        for state in message.objects:
            if state.name in samples:
                p, q = state.pose.position, state.pose.orientation
                samples[state.name].append((time, [p.x, p.y, p.z], [q.w, q.x, q.y, q.z]))
    return {
        name: _track(rows, parked_pose(i, scene.model_of(name)).p, times)
        for i, (name, rows) in enumerate(samples.items())
    }


def _track(rows: Sequence[tuple[float, list[float], list[float]]], parked: Array, times: Array) -> Track:
    p, q, upright = parked.tolist(), [1.0, 0.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0]
    first, last = (rows[0][0], rows[-1][0]) if rows else (times[-1], times[-1])
    before = [(float(times[0]), p, q), (first - INSTANT, p, upright)]
    after = [(last + INSTANT, p, q), (max(float(times[-1]), last) + 2 * INSTANT, p, q)]
    every = [*before, *rows, *after]
    return Track(
        np.array([row[0] for row in every]), np.array([row[1] for row in every]),
        np.array([row[2] for row in every]), np.zeros(len(every), dtype=np.uint8),
    )  # fmt: skip


def _none() -> Iterations:
    empty = np.zeros(0)
    return Iterations(
        empty, empty, (), empty, empty, empty, empty, np.zeros((0, 3)), np.zeros((0, 4)), ()
    )  # fmt: skip


def _seconds(message: Any) -> float:
    stamp = message.header.stamp
    return stamps.to_seconds(stamp.sec * stamps.NS_PER_S + stamp.nanosec)


def _times(messages: Sequence[Any]) -> Array:
    return np.array([_seconds(message) for message in messages])
