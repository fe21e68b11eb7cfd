"""What the executor asks its surroundings to do, one thing at a time.

Each is answered by a value: a Look by a BlockSighting or by NoPicture, a PlanFor by a Plan, a MoveArm by a
MotionStatus, a MoveFingers by a FingerState. An answer that takes too long is one that says so (STUCK,
MOVING).
"""

from __future__ import annotations

from dataclasses import dataclass

from pack_core.blocks.block_sighting import BlockSighting
from pack_core.blocks.gripper import FingerCommand, FingerState
from pack_core.blocks.plan import Plan
from pack_core.blocks.problem import Problem
from pack_core.motion.moves import Path
from pack_core.motion.target import MotionStatus, MotionTarget, ReachTolerance
from pack_core.motion.world import CarriedBox, Obstacle

REACHED = ReachTolerance(position=0.0005, orientation_deg=0.1)


@dataclass(frozen=True)
class Look:
    """Asks for a picture of the table that is taken from now on."""


@dataclass(frozen=True)
class PlanFor:
    """Asks the planner for a plan."""

    problem: Problem


@dataclass(frozen=True)
class MoveArm:
    """Moves the arm along a path until the tool has reached its end.

    Attributes:
        path: of the tool.
        opening: between the fingers meanwhile [m].
        obstacles: the table, and the blocks that stand.
        carried: the block that goes with the fingers.
        contacts: obstacles that may be touched where the move starts and ends.
    """

    path: Path
    opening: float
    obstacles: tuple[Obstacle, ...]
    carried: CarriedBox | None = None
    contacts: frozenset[str] = frozenset()

    def target(self, number: int) -> MotionTarget:
        """For the motion, with a number to be answered with; it is checked before it starts."""
        return MotionTarget(
            number, self.path, self.carried, self.obstacles, self.contacts, REACHED, opening=self.opening
        )


@dataclass(frozen=True)
class MoveFingers:
    """Moves the fingers until they have come to rest."""

    command: FingerCommand


@dataclass(frozen=True)
class NoPicture:
    """The answer where no picture was taken, or none of its poses arrived."""

    reason: str


ExecutorRequest = Look | PlanFor | MoveArm | MoveFingers
Answer = BlockSighting | NoPicture | Plan | MotionStatus | FingerState
