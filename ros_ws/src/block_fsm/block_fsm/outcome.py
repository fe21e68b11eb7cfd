"""What the executor is doing, what it has done, and how a rearrangement ended."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from pack_core.blocks.primitive_action import PrimitiveAction
from pack_core.rotations import Pose


class Phase(Enum):
    """What the executor is doing, in the order in which an action goes through them."""

    IDLE = "IDLE"
    PERCEIVE = "PERCEIVE"
    PLAN = "PLAN"
    PICK = "PICK"
    PLACE = "PLACE"
    PUSH = "PUSH"
    RETREAT = "RETREAT"
    DONE = "DONE"


class ExitReason(Enum):
    """Why the executor stopped."""

    ARRANGED = "arranged"
    NOT_SEEN = "not seen"
    NO_PLAN = "no plan"
    MOTION_FAILED = "motion failed"
    NO_PROGRESS = "no progress"
    CANCELED = "canceled"
    NODE_SILENT = "node silent"
    ARM_STOPPED = "arm stopped"


@dataclass(frozen=True)
class Tally:
    """What was done on the way.

    Attributes:
        picks: blocks picked and placed.
        pushes: blocks pushed.
        plans: plans asked for.
        failed_grasps: grasps that held nothing, lost it, or held something of another width.
        refusals: actions that the arm could not do.
        deviations: actions after which the table was not as predicted.
        disturbances: actions after which a block stood elsewhere that was not to be moved.
    """

    picks: int = 0
    pushes: int = 0
    plans: int = 0
    failed_grasps: int = 0
    refusals: int = 0
    deviations: int = 0
    disturbances: int = 0

    @property
    def actions(self) -> int:
        """Number of actions carried out, whatever came of them."""
        return self.picks + self.pushes


@dataclass(frozen=True)
class Outcome:
    """The end of a rearrangement.

    Attributes:
        exit_reason: why it ended.
        message: the same in words, with the blocks concerned.
        tally: what was done.
        position_error: largest distance of a block from its goal, as last seen [m]; NaN if none was.
        yaw_error: largest turn of a block from its goal, as last seen [rad]; NaN if none was.
    """

    exit_reason: ExitReason
    message: str
    tally: Tally
    position_error: float
    yaw_error: float

    @property
    def success(self) -> bool:
        """All blocks are where they were to be."""
        return self.exit_reason is ExitReason.ARRANGED


class Refused(Exception):
    """Raised where the arm cannot do something, and has made good what it had begun; the message says why."""

    def __init__(self, primitive: PrimitiveAction, message: str) -> None:
        super().__init__(message)
        self.primitive = primitive


class Blocked(Exception):
    """Raised where the arm got stuck at something that nobody saw; the message says in which move.

    Attributes:
        X_WT: where the tool is.
    """

    def __init__(self, X_WT: Pose, message: str) -> None:
        super().__init__(message)
        self.X_WT = X_WT


class Ended(Exception):
    """Raised where a rearrangement cannot go on; the message says what stood against it."""

    def __init__(self, reason: ExitReason, message: str) -> None:
        super().__init__(message)
        self.reason = reason
