"""The placement that a goal pursues."""

from __future__ import annotations

from dataclasses import dataclass, field

from pack_core.packing.entry import Entry
from pack_core.rotations import Pose


@dataclass(frozen=True)
class ChosenPlacement:
    """Where the held object N shall go, and by which way.

    Attributes:
        X_WN: the packing pose.
        collisions: objects that it overlaps.
        entry: the way down to it.
        is_rehearsed: whether that way was tried in simulation; if so, it is followed closely.
    """

    X_WN: Pose
    collisions: tuple[str, ...] = ()
    entry: Entry = field(default_factory=Entry)
    is_rehearsed: bool = False
