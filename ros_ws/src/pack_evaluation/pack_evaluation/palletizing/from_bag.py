"""A recording of the palletizing cell as arrays."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from pack_core.motion.moves import DEPART, Mode
from pack_core.motion.topics import (
    JOINT_STATES,
    MOTION_SEPARATION,
    MOTION_STATUS,
    MOTION_TARGET,
    SETPOINTS,
)
from pack_core.palletizing.cell import palletizing_cell
from pack_core.palletizing.imperfections import Displacement
from pack_core.palletizing.model import fixed_frames
from pack_core.palletizing.topics import CONTACTS, GRIPPER_STATE, PALLET_STATE, RESULT, TRUTH
from pack_core.robots.kr210 import BASE
from pack_core.rotations import Array, Pose
from pack_evaluation.bag import Bag, fitting, read_bag, result_in, seconds, times_of
from pack_evaluation.goals import goal_of
from pack_evaluation.palletizing.run import (
    BoxRecord,
    PalletRun,
    SeparationTrack,
    StandingCell,
    StateVisit,
    ToolTrack,
    UnwantedTouch,
    VisitorTrack,
    intervals,
    tool_track,
)
from pack_evaluation.track import recorded_tracks

TF_STATIC, DECK = "/tf_static", "pallet_deck"
"""The topic that has the frames of what stands still, and the pallet's frame."""
TOPICS = (
    JOINT_STATES, SETPOINTS, TRUTH, GRIPPER_STATE, PALLET_STATE, RESULT, CONTACTS, MOTION_STATUS,
    MOTION_TARGET, TF_STATIC, MOTION_SEPARATION,
)  # fmt: skip
NEAR = 0.75
"""Share of the usual time between setpoints; a moment farther from all setpoints had none to follow."""
TABLES = ("picking_table", "reorientation_table")


def load_pallet_run(path: Path, goal: int | None = None) -> PalletRun:
    """Read a recorded order.

    Args:
        path: a run's folder, a bag's folder or an MCAP file.
        goal: which order of a recording with several, from 1; None: the last.

    Raises:
        BagError: the recording is missing, broken, or holds no order.
    """
    with fitting(path):
        return _pallet_run(path, goal)


def _pallet_run(path: Path, goal: int | None) -> PalletRun:
    bag, number = goal_of(
        read_bag(path, TOPICS), goal, result=RESULT, latched=(TF_STATIC,),
        needed=(JOINT_STATES, SETPOINTS, TRUTH, PALLET_STATE, RESULT),
        has_begun=lambda rest: any(item.topic == PALLET_STATE for item in rest),
    )  # fmt: skip
    result = result_in(bag.of(RESULT)[-1].data, bag.path)
    frames = frames_in(bag)
    X_true = true_of_known(frames, result)
    visits = tuple(
        StateVisit(message.state, seconds(message.header.stamp), message.box, message.reason)
        for message in bag.of(PALLET_STATE)
    )
    return PalletRun(
        order=result["order"], seed=0, reason=result["reason"],
        boxes=tuple(_box(box, X_true) for box in result["boxes"]), visits=visits,
        tool=tool_of(bag, visits[0].time), tracks=recorded_tracks(bag.of(TRUTH)),
        touches=tuple(
            UnwantedTouch(seconds(item.header.stamp), (item.bodies[0], item.bodies[1]), item.force)
            for item in bag.of(CONTACTS)
        ),
        cycles={box["name"]: box["cycle_s"] for box in result["boxes"] if box["cycle_s"] is not None},
        grip_peaks=_peaks(bag.of(GRIPPER_STATE)), interruptions=interruptions_of(bag.of(MOTION_STATUS)),
        is_cut=bag.is_cut, damaged=bag.damaged, notes=bag.notes, goal=number, stands=standing_cell(frames),
        slow=slow_intervals(bag.of(MOTION_TARGET), bag.of(MOTION_STATUS)),
        visitors=_visitors(bag.of(MOTION_SEPARATION)), separation=_separation(bag.of(MOTION_SEPARATION)),
    )  # fmt: skip


def true_of_known(frames: Mapping[str, Pose], result: dict[str, Any]) -> Pose:
    """The transform from the world as the cell knows it to the true one, at the pallet.

    A real cell knows where the pallet lies only relative to its arm, and boxes count as placed where they
    belong on the pallet as it truly lies. It is the identity where a recording does not say.
    """
    if DECK not in frames or "pallet" not in result:
        return Pose(np.zeros(3))
    known = np.array(result["pallet"])
    return frames[DECK] @ Pose(known[:3], known[3:]).inverse()


def _box(box: dict[str, Any], X_true: Pose) -> BoxRecord:
    pose = np.array(box["pose"])
    return BoxRecord(
        box["name"], (box["dims"][0], box["dims"][1], box["dims"][2]), box["mass"], box["handling"],
        box["outcome"], box["reason"], box["direction"], X_true @ Pose(pose[:3], pose[3:]),
        box.get("weighed"),
    )  # fmt: skip


def tool_of(bag: Bag, start: float) -> ToolTrack:
    """Measured tool poses since `start` [s], and those that the newest setpoints command at the same times.

    Moments without setpoints, at which the driver holds the arm, are left out.
    """
    measured = [item for item in bag.of(JOINT_STATES) if seconds(item.header.stamp) >= start]
    times = times_of(measured)
    wanted = {
        seconds(message.header.stamp) + seconds(point.time_from_start): point.positions
        for message in bag.of(SETPOINTS)
        for point in message.points
    }
    rows = np.array(sorted(wanted))
    positions = np.array([wanted[time] for time in rows])
    q_ref = np.stack([np.interp(times, rows, column) for column in positions.T], axis=1)
    are_told = _are_near(times, rows)
    q = np.array([item.position for item in measured])
    return tool_track(times[are_told], q_ref[are_told], q[are_told])


def _are_near(times: Array, rows: Array) -> npt.NDArray[np.bool_]:
    """Which of `times` `(n,)` are near the time of a setpoint, one of `rows`."""
    after = np.clip(rows.searchsorted(times), 1, len(rows) - 1)
    distance = np.minimum(np.abs(times - rows[after - 1]), np.abs(times - rows[after]))
    return np.asarray(distance <= NEAR * np.median(np.diff(rows)))


def interruptions_of(messages: Sequence[Any]) -> int:
    """Number of times that the driver held the arm during a move."""
    are_held = [message.state == "HELD" for message in messages]
    return sum(now and not before for before, now in pairwise([False, *are_held]))


def slow_intervals(targets: Sequence[Any], statuses: Sequence[Any]) -> tuple[tuple[float, float], ...]:
    """From when to when the running segment was one of mode SLOW [s]."""
    modes = {target.id: {item.label: item.mode for item in target.segments} for target in targets}

    def is_slow(status: Any) -> bool:
        own = modes.get(status.id, {}).get(status.label)
        return bool(status.label == DEPART if own is None else own == Mode.SLOW.value)

    return intervals([seconds(item.header.stamp) for item in statuses], [is_slow(item) for item in statuses])


def _visitors(messages: Sequence[Any]) -> dict[str, VisitorTrack]:
    """Who was seen, while nobody else had less of a margin; empty in a recording older than the topic."""
    by_name: dict[str, list[Any]] = {}
    for message in messages:
        by_name.setdefault(message.who, []).append(message)
    return {
        name: VisitorTrack(times_of(own), np.array([message.distance for message in own]))
        for name, own in by_name.items()
    }


def _separation(messages: Sequence[Any]) -> SeparationTrack | None:
    """The margins that were told; None where nobody was seen, or the recording is older than the topic."""
    if not messages:
        return None
    margin = np.array([message.margin for message in messages])
    return SeparationTrack(times_of(messages), margin, np.array([item.is_under_way for item in messages]))


def _peaks(messages: Sequence[Any]) -> dict[str, tuple[float, float, float]]:
    peaks: dict[str, tuple[float, float, float]] = {}
    for message in messages:
        if message.object:
            worst = peaks.get(message.object, (0.0, 0.0, 0.0))
            load = (message.coaxial_force, message.shear_force, message.moment)
            peaks[message.object] = tuple(np.maximum(worst, load).tolist())
    return peaks


def frames_in(bag: Bag) -> dict[str, Pose]:
    """The true poses of what stands still in the world, by the names of the frames; the newest of each."""
    found: dict[str, Pose] = {}
    for message in bag.of(TF_STATIC):
        for item in message.transforms:
            if item.header.frame_id == "world":
                p, q = item.transform.translation, item.transform.rotation
                pose = Pose(np.array([p.x, p.y, p.z]), np.array([q.w, q.x, q.y, q.z]))
                found[item.child_frame_id] = pose
    return found


def standing_cell(frames: dict[str, Pose]) -> StandingCell:
    """The cell with tables, pallet and arm at the poses of frames; what has none stands where it should."""
    cell = palletizing_cell()
    nominal = {name: Pose(getattr(cell, name).middle) for name in TABLES}
    nominal["pallet"] = fixed_frames(cell)[DECK][1]
    true = {**frames, "pallet": frames.get(DECK, nominal["pallet"])}
    moved = {
        name: getattr(cell, name).model_copy(
            update={"displacement": Displacement.between(X_WF, true[name], getattr(cell, name).middle)}
        )
        for name, X_WF in nominal.items()
        if name in true
    }
    return StandingCell(cell.model_copy(update=moved), frames.get(BASE))
