"""Moves that can be commanded, from single segments to searched transfers."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

import numpy as np

from pack_core.rotations import Array, Pose

DOWN = np.array([0.0, 0.0, -1.0])
UP = np.array([0.0, 0.0, 1.0])
"""Directions in the world."""


class Mode(Enum):
    """How the policies are tuned: FAST through free space, SLOW near contact.

    Joint and pose moves in SLOW keep the tool below `SLOW_SPEED`, too; a line states its own speed.
    """

    FAST = "FAST"
    SLOW = "SLOW"


SLOW_SPEED = 0.25
"""Of the tool in SLOW, at most [m/s]."""


@dataclass(frozen=True)
class JointMove:
    """Fastest jerk-limited move to joint positions, straight or not.

    Attributes:
        q: where to `(n,)` [rad].
        speed: share of the joint velocity limits, at most 1.
        acceleration: share of the joint acceleration limits, at most 1.
        stop: whether to come to rest at its end though something follows.
        label: what status and reports call this part.
        mode: how the policies are tuned.
    """

    q: Array
    speed: float = 1.0
    acceleration: float = 1.0
    stop: bool = False
    label: str = "joint move"
    mode: Mode = Mode.FAST


@dataclass(frozen=True)
class PoseMove:
    """As JointMove, to a tool pose; the branch of the arm stays, the wrist turns as is quickest."""

    X_WT: Pose
    speed: float = 1.0
    acceleration: float = 1.0
    stop: bool = False
    label: str = "pose move"
    mode: Mode = Mode.FAST


@dataclass(frozen=True)
class Line:
    """Straight line of the tool, its orientation turned evenly.

    Attributes:
        X_WT: its end.
        speed: of the tool, at most [m/s].
        acceleration: of the tool, at most [m/s^2].
        entry_speed: at its start, at most, when a joint or pose move leads there [m/s]; 0 starts from rest.
        exit_speed: at its end, at most, when something follows [m/s]; 0 stops there.
        blend: length of both lines cut off to round the corner to a following line [m]; with 0 it is
            passed only where the lines are in line, and a stop otherwise.
        label: what status and reports call this part.
        mode: how the policies are tuned.
    """

    X_WT: Pose
    speed: float = 0.5
    acceleration: float = 2.5
    entry_speed: float = 0.0
    exit_speed: float = 0.0
    blend: float = 0.0
    label: str = "line"
    mode: Mode = Mode.SLOW


Segment = JointMove | PoseMove | Line


@dataclass(frozen=True)
class Path:
    """Segments, run one after the other without stops where they allow it; ends at rest."""

    segments: tuple[Segment, ...]


@dataclass(frozen=True)
class Retreat:
    """A line away from a pose, of a length that is searched.

    Attributes:
        direction: in the world `(3,)`; of any length.
        lengths: shortest and longest [m].
        speed: of the tool, at most [m/s].
        acceleration: of the tool, at most [m/s^2].
        pass_speed: at its far end, which is passed and no stop, at most [m/s].
        slow_length: length of a segment at its near end, where the tool or its box touches something [m].
        slow_speed: of the tool on that segment, at most [m/s].
    """

    direction: Array
    lengths: tuple[float, float]
    speed: float = 0.5
    acceleration: float = 2.5
    pass_speed: float = 0.25
    slow_length: float = 0.0
    slow_speed: float = 0.25


@dataclass(frozen=True)
class Transfer:
    """Away from here, through free space, and in along lines: the shortest clear one is searched.

    Attributes:
        lines: how the goal is approached; the first starts at the hover pose.
        hover: from the first line's end back to the hover pose; its speeds are those of the first line,
            but for the `pass_speed`.
        depart: how the tool leaves where it is; None where it need not.
        speed: share of the joint velocity limits on the way.
        acceleration: share of the joint acceleration limits on the way.
    """

    lines: tuple[Line, ...]
    hover: Retreat
    depart: Retreat | None = None
    speed: float = 1.0
    acceleration: float = 1.0


Move = Path | Transfer

DEPART, RISE, TRANSIT, DESCEND = "depart", "rise", "transit", "descend"
"""Labels of the segments that the search puts before a transfer's own lines. DEPART is SLOW, the others are
FAST."""
