"""What the executor asks its surroundings to do, one thing at a time.

Each is answered by a value: a Look by a BlockSighting, a PlanFor by a Plan, a MoveArm by a MotionStatus,
a MoveJaw by a JawState. An answer that takes too long is one that says so (STUCK, MOVING, all missing).
"""

from __future__ import annotations

from dataclasses import dataclass

from pack_core.block_sighting import BlockSighting
from pack_core.jaw import JawCommand, JawState
from pack_core.motion.moves import Path
from pack_core.motion.target import MotionStatus
from pack_core.rearrangement.plan import Plan
from pack_core.rearrangement.problem import Problem


@dataclass(frozen=True)
class Look:
    """A picture of the table, taken from now on."""


@dataclass(frozen=True)
class PlanFor:
    """A plan for a problem."""

    problem: Problem


@dataclass(frozen=True)
class MoveArm:
    """Along a path, until the tool has reached its end."""

    path: Path


@dataclass(frozen=True)
class MoveJaw:
    """Until the fingers have come to rest."""

    command: JawCommand


Request = Look | PlanFor | MoveArm | MoveJaw
Answer = BlockSighting | Plan | MotionStatus | JawState
