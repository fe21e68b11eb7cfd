"""An object's path through a run."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from pack_core import rotations
from pack_core.rotations import Array, Pose
from pack_core.states import ObjectState, SceneState, Source

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


def to_tracks(states: Iterable[SceneState]) -> dict[str, Track]:
    """The path of every object through scenes in order of time."""
    samples: dict[str, list[tuple[float, ObjectState]]] = {}
    for state in states:
        for name, item in state.objects.items():
            samples.setdefault(name, []).append((state.time, item))
    return {name: _to_track(found) for name, found in samples.items()}


def _to_track(samples: list[tuple[float, ObjectState]]) -> Track:
    return Track(
        times=np.array([time for time, _ in samples]), p=np.array([item.X_WO.p for _, item in samples]),
        q=np.array([item.X_WO.q for _, item in samples]),
        sources=np.array([item.source for _, item in samples], dtype=np.uint8),
    )  # fmt: skip
