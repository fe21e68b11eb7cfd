"""A target for the motion controller, and what it reports back."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from pack_core.motion.moves import Move
from pack_core.motion.world import CarriedBox, Obstacle
from pack_core.rotations import Pose


@dataclass(frozen=True)
class ReachTolerance:
    """When a target counts as reached: measured errors for this many steps in a row."""

    position: float = 0.002
    """[m]"""
    orientation_deg: float = 0.5
    steps: int = 3


@dataclass(frozen=True)
class MotionTarget:
    """A move, and what it is made among.

    Attributes:
        id: given back in the status.
        move: what to do.
        carried: the box in the hand during the move.
        obstacles: what must not be touched.
        contacts: names of obstacles that the hand or its box touches where the move starts or ends;
            they may be near on the first and last line, and nowhere else.
        tolerance: when the move's end is reached.
        is_checked: whether the clearance of the whole move is checked before it starts.
        opening: between the fingers of a gripper that has them [m].
    """

    id: int
    move: Move
    carried: CarriedBox | None = None
    obstacles: tuple[Obstacle, ...] = ()
    contacts: frozenset[str] = frozenset()
    tolerance: ReachTolerance = ReachTolerance()
    is_checked: bool = True
    opening: float = 0.0


class MotionState(Enum):
    """What the controller is doing."""

    IDLE = "IDLE"
    MOVING = "MOVING"
    SETTLING = "SETTLING"
    REACHED = "REACHED"
    HELD = "HELD"
    """Its driver held the arm while no setpoints came; what is left of the move is being planned anew."""
    STUCK = "STUCK"
    REFUSED = "REFUSED"


@dataclass(frozen=True)
class Acceptance:
    """Answer to a target: the planned duration [s], or why it was refused."""

    is_accepted: bool
    reason: str = ""
    duration: float = 0.0


@dataclass(frozen=True)
class MotionStatus:
    """Where a move stands.

    Attributes:
        time: of the measurement [s].
        id: of the target.
        state: what the controller is doing.
        segment: index of the running segment; -1 before the first target.
        label: of the running segment.
        remaining: planned time to the end [s].
        position_error: measured tool to the target [m].
        orientation_error: measured tool to the target [rad].
        path_error: measured tool to the commanded one [m].
        reached_steps: how many steps in a row the tool has been within tolerance of the target.
        reason: why it was refused, is held or is stuck; empty otherwise.
        X_WT: the measured tool.
    """

    time: float
    id: int
    state: MotionState
    segment: int
    label: str
    remaining: float
    position_error: float
    orientation_error: float
    path_error: float
    reached_steps: int
    reason: str
    X_WT: Pose
