"""What the task asks of the controller: stage, which decides the weights, and target."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum

import numpy as np

from pack_core.rotations import Array


class Stage(Enum):
    """Stages of the task (section III-B2), and LOOK, which comes first while an object has no pose."""

    LOOK = "look"
    PRE_PACK = "pre_pack"
    INSERT = "insert"
    FINE_TUNE = "fine_tune"


@dataclass(frozen=True)
class PackingTarget:
    """Where the held object N shall go.

    Attributes:
        p_WN: position `(3,)` [m].
        yaw: heading [rad].
        axis: x and y `(2,)` of the object's z axis; zero means upright.
        over: horizontal unit vector `(2,)` towards the obstacles; zero if no side is clear of them.
        collisions: names of the objects that overlap the packing pose (the paper's collision list G).
        may_land: whether the object may come down on top of another one, or of a wall, on its way.
        is_rehearsed: whether the target lies on an entry that was tried in simulation beforehand.
        press: force down on the held object beyond what the cost asks for [N].
    """

    p_WN: Array
    yaw: float
    axis: Array = field(default_factory=lambda: np.zeros(2))
    over: Array = field(default_factory=lambda: np.zeros(2))
    collisions: tuple[str, ...] = ()
    may_land: bool = False
    is_rehearsed: bool = False
    press: float = 0.0
