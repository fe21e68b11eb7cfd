"""Brings an empty hand aside that was left where nobody can see past it."""

from __future__ import annotations

import numpy as np

from pack_core.motion.target import MotionState
from pack_core.motion.world import Obstacle
from pack_core.palletizing.cell import PalletizingCell
from pack_core.palletizing.ports import PalletObservation, PursueTarget
from pack_core.rotations import Array
from pallet_fsm.blended_moves import BlendedMoves
from pallet_fsm.goals import Goals
from pallet_fsm.leg_runner import Mover
from pallet_fsm.palletizer_config import PalletizerConfig
from pallet_fsm.states import State, profile_of
from pallet_fsm.transitions import Event

NEXT_TO = 0.05
"""Boxes that are nearer to the middle of the pad may be touched as the hand leaves them [m]."""


class StepAside:
    """Brings the empty hand up and to its safe position, from wherever the arm was left.

    Args:
        cell: the cell's physical facts.
        config: parameters of the machine.
        boxes: those that stand in the cell; ones next to the pad may be touched as it goes up.
    """

    def __init__(self, cell: PalletizingCell, config: PalletizerConfig, boxes: tuple[Obstacle, ...]) -> None:
        self._obstacles, self._boxes = (*cell.furniture, *boxes), boxes
        self._mover = Mover(profile_of("blended"), config.mover)
        self._moves = BlendedMoves(Goals(cell, config.poses), config.blended, config.thesis)

    @property
    def is_moving(self) -> bool:
        """Whether the hand is on its way."""
        return self._mover.leg is not None

    @property
    def reason(self) -> str:
        """Why there is no way; empty as long as there may be one."""
        return self._mover.reason

    def step(self, seen: PalletObservation) -> PursueTarget | Event | None:
        """The target that the motion is to pursue, or how the move has ended."""
        if self._mover.leg is not None:
            return self._mover.follow(seen.motion, State.RETURN)
        if seen.motion.state in (MotionState.MOVING, MotionState.SETTLING, MotionState.HELD):
            return None  # the last move that was asked for ends first
        X_WT = seen.motion.X_WT
        touched = frozenset(box.name for box in self._boxes if _gap(box, X_WT.p) < NEXT_TO)
        legs = [(leg, touched) for leg in self._moves.legs(State.RETREAT, State.RETURN, None, X_WT)]
        return self._mover.begin(legs, None, self._obstacles, seen.motion, seen.time)


def _gap(box: Obstacle, p_W: Array) -> float:
    """Distance of a point from a box [m]; 0 inside."""
    beyond = np.abs(box.X_WO.inverse().apply(p_W)) - 0.5 * box.size
    return float(np.linalg.norm(np.maximum(beyond, 0.0)))
