"""A placement to go for."""

from __future__ import annotations

from dataclasses import dataclass, field

from pack_core.rotations import Pose
from pack_core.scene.entry import Entry


@dataclass(frozen=True)
class Placement:
    """A packing pose X_WN for the held object N, the objects that it overlaps, and the way down to it."""

    X_WN: Pose
    collisions: tuple[str, ...] = ()
    entry: Entry = field(default_factory=Entry)
