"""An object's path through a run, from recorded messages or from states."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from pack_core import rotations
from pack_core.rotations import Array, Pose
from pack_core.states import SceneState, Source
from pack_evaluation.bag import seconds

Sources = npt.NDArray[np.uint8]


@dataclass(frozen=True)
class Track:
    """Poses X_WO of an object at T times.

    Attributes:
        times: `(T,)` [s], rising.
        p: positions `(T, 3)` [m].
        q: orientations `(T, 4)`, wxyz.
        sources: `(T,)`, values of `Source`.
    """

    times: Array
    p: Array
    q: Array
    sources: Sources

    def at(self, times: Array) -> Track:
        """The track at other times: positions linear between samples, rotations of the nearest."""
        p = np.stack([np.interp(times, self.times, axis) for axis in self.p.T], axis=-1)
        nearest = np.searchsorted(0.5 * (self.times[1:] + self.times[:-1]), times)
        return Track(times, p, self.q[nearest], self.sources[nearest])

    def last_pose(self, time: float) -> Pose:
        """X_WO of the last sample until `time` [s]; of the first one if there is none."""
        return self.pose(max(int(self.times.searchsorted(time, side="right")) - 1, 0))

    def between(self, start: float, end: float) -> Track:
        """The samples from `start` to `end` [s], both included."""
        rows = (self.times >= start) & (self.times <= end)
        return Track(self.times[rows], self.p[rows], self.q[rows], self.sources[rows])

    def displacement(self) -> Array:
        """Distance from the first position `(T,)` [m]."""
        return np.asarray(np.linalg.norm(self.p - self.p[0], axis=-1))

    def distance_to(self, p_WT: Array) -> Array:
        """Distance `(T,)` [m] to points `(T, 3)` or `(3,)`."""
        return np.asarray(np.linalg.norm(self.p - p_WT, axis=-1))

    def angle_to(self, other: Track) -> Array:
        """Angle of the rotation to another track's orientations `(T,)` [rad]."""
        return rotations.angle_between(self.q, other.q)

    def pose(self, i: int) -> Pose:
        """X_WO of sample `i`."""
        return Pose(self.p[i], self.q[i])

    @property
    def is_predicted(self) -> npt.NDArray[np.bool_]:
        """Where the pose was carried by physics instead of seen `(T,)`."""
        return np.asarray(self.sources == Source.PHYSICS)


Sample = tuple[float, Any, Any, int]
"""Time [s], position `(3,)` [m], orientation wxyz `(4,)`, and a value of `Source`."""


def to_tracks(states: Iterable[SceneState]) -> dict[str, Track]:
    """The path of every object through scenes in order of time."""
    return tracks_of(
        (name, (state.time, item.X_WO.p, item.X_WO.q, item.source))
        for state in states
        for name, item in state.objects.items()
    )


def recorded_tracks(messages: Iterable[Any]) -> dict[str, Track]:
    """The path of every object through recorded `SceneState`s in order of time."""
    return tracks_of(
        (item.name, (time, position(item.pose), orientation(item.pose), item.source))
        for message in messages
        for time in [seconds(message.header.stamp)]
        for item in message.objects
    )


def tracks_of(samples: Iterable[tuple[str, Sample]]) -> dict[str, Track]:
    """The paths of objects by name, from samples of any of them in order of time."""
    by_name: dict[str, list[Sample]] = {}
    for name, sample in samples:
        by_name.setdefault(name, []).append(sample)
    return {name: track_of(found) for name, found in by_name.items()}


def track_of(samples: Sequence[Sample]) -> Track:
    """A path from its samples, also from none."""
    times, p, q, sources = zip(*samples, strict=True) if samples else ((), (), (), ())
    return Track(
        np.array(times, dtype=float), np.array(p, dtype=float).reshape(-1, 3),
        np.array(q, dtype=float).reshape(-1, 4), np.array(sources, dtype=np.uint8),
    )  # fmt: skip


def position(pose: Any) -> list[float]:
    """Position of a recorded `Pose` `(3,)` [m]."""
    return [pose.position.x, pose.position.y, pose.position.z]


def orientation(pose: Any) -> list[float]:
    """Orientation of a recorded `Pose`, wxyz `(4,)`."""
    q = pose.orientation
    return [q.w, q.x, q.y, q.z]
