"""The visible state of the cell at one moment."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from pack_core.palletizing.box_body import BoxBody
from pack_core.rotations import Array, Pose


@dataclass(frozen=True)
class Snapshot:
    """The arm's positions `q` `(6,)` [rad] and the boxes' poses X_WB at `time` [s]."""

    time: float
    q: Array
    boxes: Mapping[BoxBody, Pose]
