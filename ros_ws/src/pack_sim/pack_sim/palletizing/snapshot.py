"""The visible state of the cell at one moment."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import mujoco

from pack_core.palletizing.boxes import BoxBody
from pack_core.rotations import Array, Pose


@dataclass(frozen=True)
class Snapshot:
    """The arm's positions `q` `(6,)` [rad] and the boxes' poses X_WB at `time` [s]."""

    time: float
    q: Array
    boxes: Mapping[BoxBody, Pose]


@dataclass(frozen=True)
class PhysicsSnapshot:
    """The state of the physics at `time` [s], with body poses, for whoever looks at it in another thread."""

    time: float
    model: mujoco.MjModel
    data: mujoco.MjData
