"""Values that cells pass around: where objects, markers and joints are at a time."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import IntEnum

import numpy as np
import numpy.typing as npt

from pack_core.rotations import Array, Pose


class Source(IntEnum):
    """Where an object's pose comes from; the values of pack_interfaces/ObjectState."""

    TRUTH = 0
    MOCAP = 1
    PHYSICS = 2


@dataclass(frozen=True)
class ObjectState:
    """Pose and twist of an object O.

    Attributes:
        X_WO: its pose.
        v_WO_W: velocity of its origin `(3,)` [m/s] in world axes.
        w_WO_W: angular velocity `(3,)` [rad/s] in world axes.
        source: where it comes from.
        age: time since it was last seen [s].
    """

    X_WO: Pose
    v_WO_W: Array = field(default_factory=lambda: np.zeros(3))
    w_WO_W: Array = field(default_factory=lambda: np.zeros(3))
    source: Source = Source.TRUTH
    age: float = 0.0


@dataclass(frozen=True)
class SceneState:
    """All objects, the held one included, at `time` [s]."""

    time: float
    objects: Mapping[str, ObjectState]

    def poses(self) -> dict[str, Pose]:
        """X_WO by name."""
        return {name: state.X_WO for name, state in self.objects.items()}


@dataclass(frozen=True)
class MarkerFrame:
    """One motion capture frame with n visible markers.

    Attributes:
        time: of exposure [s].
        objects: names that `object_index` points into.
        object_index: `(n,)`.
        marker_index: `(n,)`, row of `markers()` of the object's model.
        p_WM: positions `(n, 3)` [m].
        cameras: how many cameras see each `(n,)`.
    """

    time: float
    objects: tuple[str, ...]
    object_index: npt.NDArray[np.int_]
    marker_index: npt.NDArray[np.int_]
    p_WM: Array
    cameras: npt.NDArray[np.int_]


@dataclass(frozen=True)
class JointSample:
    """Measured joints at `time` [s]: `q` [rad], `v` [rad/s], `tau` [N m], each `(7,)`."""

    time: float
    q: Array
    v: Array
    tau: Array


@dataclass(frozen=True)
class Setpoints:
    """Joint references over a horizon.

    Attributes:
        time: of the first row [s].
        offsets: of each row from `time` `(T,)` [s], rising from 0.
        q: `(T, 7)` [rad].
        v: `(T, 7)` [rad/s].
        tau: feed-forward torque `(T, 7)` [N m].
    """

    time: float
    offsets: Array
    q: Array
    v: Array
    tau: Array

    def at(self, time: float) -> tuple[Array, Array, Array]:
        """Position, velocity and torque `(7,)` at `time` [s]: interpolated, and held beyond the ends."""
        offset, offsets = time - self.time, self.offsets
        last = len(offsets) - 1
        i = min(max(int(np.searchsorted(offsets, offset, side="right")) - 1, 0), last)
        j = min(i + 1, last)
        span = offsets[j] - offsets[i]
        s = min(max((offset - offsets[i]) / span, 0.0), 1.0) if span > 0 else 0.0
        q, v, tau = ((1 - s) * rows[i] + s * rows[j] for rows in (self.q, self.v, self.tau))
        return q, v, tau

    def until(self, offset: float) -> Setpoints:
        """The rows up to `offset` [s] from the first."""
        n = int(np.searchsorted(self.offsets, offset, side="right"))
        return Setpoints(self.time, self.offsets[:n], self.q[:n], self.v[:n], self.tau[:n])
