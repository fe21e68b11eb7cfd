"""Where the objects of a cell are at a moment, and how that is known."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import IntEnum

import numpy as np

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
        source: how the pose is known.
        age: time since it was last seen [s].
    """

    X_WO: Pose
    v_WO_W: Array = field(default_factory=lambda: np.zeros(3))
    w_WO_W: Array = field(default_factory=lambda: np.zeros(3))
    source: Source = Source.TRUTH
    age: float = 0.0


@dataclass(frozen=True)
class SceneState:
    """States of all objects by name, the held one included, at `time` [s]."""

    time: float
    objects: Mapping[str, ObjectState]

    def poses(self) -> dict[str, Pose]:
        """X_WO of every object by name."""
        return {name: state.X_WO for name, state in self.objects.items()}
