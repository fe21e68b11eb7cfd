"""A recorded fill job: what the node reported of it, and what the recording itself shows."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from pack_core import stamps
from pack_core.errors import BagError
from pack_core.packing.model import parked_pose
from pack_core.packing.objects import ObjectModel
from pack_core.packing.scene import Scene
from pack_core.packing.topics import DESCRIPTION, FILL_PROGRESS, FILL_RESULT, JOINT_STATES, TRUTH, WRENCH
from pack_core.robots.packing_arms import arm_of
from pack_core.rotations import Array, Pose
from pack_evaluation.bag import Bag, fitting, read_bag, result_in, times_of
from pack_evaluation.goals import RecordedRun
from pack_evaluation.packing.fill.true_end import TrueEnd, true_end
from pack_evaluation.packing.force import low_pass
from pack_evaluation.packing.from_bag import magnitudes
from pack_evaluation.packing.run import Iterations, Run
from pack_evaluation.raw_bag import read_raw_bag
from pack_evaluation.track import Track, recorded_tracks, track_of

NEEDED = (DESCRIPTION, TRUTH, JOINT_STATES, WRENCH)
REPORTS = (FILL_PROGRESS, FILL_RESULT)
"""What the node reports of a job: its result, or, of a job that was cut off, its last progress."""
INSTANT = 1e-3
"""Time in which an object comes from where it is parked to where it is handed over, in pictures [s]."""


@dataclass(frozen=True)
class FillRun(RecordedRun):
    """A fill job of a recording.

    Attributes:
        run: the cell over the job's time, with all objects that were ever in it.
        report: fields of `/fill_container/result`; of a job that was cut off, those of its last progress.
        given: names of the objects of the list.
        truth: how the job truly ended.
        force_peak: largest external force, behind a low-pass of 5 ms [N].
    """

    run: Run
    report: Mapping[str, Any]
    given: frozenset[str]
    truth: TrueEnd
    force_peak: float

    @property
    def packed(self) -> list[str]:
        """Names of the objects of the list that truly are in the container; others may be in it, too."""
        return [name for name in self.truth.inside if name in self.given]

    @property
    def faults(self) -> list[str]:
        """Names of the objects that were dropped, that ended outside, or whose goal a force stop ended."""
        reported = {str(row["name"]) for row in self.report["objects"] if row["fault"]}
        return sorted(reported | set(self.truth.outside))

    @property
    def durations(self) -> list[float]:
        """Times of the objects that are in the container, from hand-over until the arm was free again [s]."""
        rows = self.report["objects"]
        return [float(row["duration"]) for row in rows if row["name"] in self.truth.inside]


def end_of(report: Mapping[str, Any]) -> float:
    """When a job last did something, by its result [s]; its start, if it ended before it did anything."""
    return float(report["fills"][-1][0]) if report["fills"] else float(report["start"])


def has_fill_job(path: Path) -> bool:
    """Whether a recording holds a fill job, to its end or cut off."""
    is_bag = path.is_dir() or path.suffix == ".mcap"
    return is_bag and bool(read_raw_bag(path, REPORTS).messages)


def load_fill_run(path: Path) -> FillRun:
    """The last fill job of a recording.

    Raises:
        BagError: the recording is missing, broken, or holds none.
    """
    bag = read_bag(path, (*NEEDED, *REPORTS))
    reports = [item for item in bag.messages if item.topic in REPORTS]
    if missing := [topic for topic in NEEDED if not bag.of(topic)] + [FILL_RESULT] * (not reports):
        raise BagError(
            f"{bag.path} has no message on {', '.join(missing)}{bag.reason('') and ': ' + bag.reason('')}"
        )
    with fitting(path):
        told = [result_in(item.message.data, path) for item in reports]
        report = told[-1]
        start, is_ended = float(report["start"]), reports[-1].topic == FILL_RESULT
        given = _given([earlier for earlier in told if earlier["start"] == report["start"]])
        job = _since(bag, start)
        scene = _all_objects([Scene.from_yaml(m.data, DESCRIPTION) for m in job.of(DESCRIPTION)])
        joints, wrenches = bag.of(JOINT_STATES), bag.of(WRENCH)
        times, force_times, force = times_of(joints), times_of(wrenches), magnitudes(wrenches)
        seen = recorded_tracks(job.of(TRUTH))
        paths = {name: seen.get(name, track_of(())) for name in (*scene.names, scene.new_object.name)}
        end = end_of(report) if is_ended else float(times[-1])
        if not is_ended:
            report = {"exit_reason": "", "message": "the recording ends before the job", **report}
        run = Run(
            scene=scene, start=start, end=end, iterations=Iterations(), truth=_tracks(paths, scene, times),
            estimate={}, joint_times=times, joints=np.array([message.position for message in joints]),
            force_times=force_times, force=force, outcome=dict(report), arm=arm_of(joints[0].name).name,
        )  # fmt: skip
        during = (force_times >= start) & (force_times <= end)
        peak = report.get("force_peak", np.max(low_pass(force_times, force)[during], initial=0.0))
        return FillRun(
            run, report, given, true_end(scene, _ends(paths, end)), float(peak), is_cut=bag.is_cut,
            damaged=bag.damaged, notes=bag.notes,
        )  # fmt: skip


def _given(reports: Sequence[Mapping[str, Any]]) -> frozenset[str]:
    """Names of the objects of a job's list, from all that the node reported of the job.

    The result of a job that ends early lacks the objects that were still to come; the progress has them.
    """
    handled = {row["name"] for report in reports for row in report["objects"]}
    to_come = {name for report in reports for name in (*report.get("to_come", ()), report.get("object", ""))}
    return frozenset(filter(None, handled | to_come))  # between two objects `object` is empty


def _since(bag: Bag, start: float) -> Bag:
    """The recording from `start` [s] on, and the description of the cell that held then."""
    since = [item for item in bag.messages if item.time_ns >= stamps.to_ns(start)]
    until = bag.messages[: len(bag.messages) - len(since)]
    held = [item for item in until if item.topic == DESCRIPTION][-1:]
    return replace(bag, messages=(*held, *since))


def _all_objects(descriptions: Sequence[Scene]) -> Scene:
    """The last description, with every object that any of them has from the first handed over on."""
    items: dict[str, ObjectModel] = {}
    for scene in descriptions:
        if scene.is_handed_over:
            for item in (*scene.objects, scene.new_object):
                items[item.name] = item.model_copy(update={"pose": None})
    *objects, new = items.values()
    return descriptions[-1].model_copy(update={"objects": objects, "new_object": new, "grip": None})


def _tracks(paths: Mapping[str, Track], scene: Scene, times: Array) -> dict[str, Track]:
    """The paths over the whole time, the objects parked while they are not in the cell."""
    return {
        name: _over_all_times(path, parked_pose(i, scene.model_of(name)).p, times)
        for i, (name, path) in enumerate(paths.items())
    }


def _over_all_times(path: Track, parked: Array, times: Array) -> Track:
    inside, begin, end = path.times, float(times[0]), float(times[-1])
    first, last = (inside[0], inside[-1]) if inside.size else (end, end)
    before, after = [begin, first - INSTANT], [last + INSTANT, max(end, last) + 2 * INSTANT]
    away, upright = np.tile(parked, (2, 1)), np.tile([1.0, 0.0, 0.0, 0.0], (2, 1))
    return Track(
        np.concatenate([before, inside, after]), np.concatenate([away, path.p, away]),
        np.concatenate([upright, path.q, upright]), np.zeros(len(inside) + 4, dtype=np.uint8),
    )  # fmt: skip


def _ends(paths: Mapping[str, Track], end: float) -> dict[str, tuple[Pose, Pose]]:
    """First and last pose of every object that was in the cell until `end` [s], by name."""
    until = {name: path.between(-np.inf, end) for name, path in paths.items()}
    return {name: (path.pose(0), path.pose(-1)) for name, path in until.items() if path.times.size}
