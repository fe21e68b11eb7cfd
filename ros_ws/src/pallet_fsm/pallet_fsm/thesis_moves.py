"""Moves of the profile `thesis`: one to each state's target, with a stop there (section 8.4)."""

from __future__ import annotations

import numpy as np

from pack_core.motion.moves import Line, Mode, Path, PoseMove
from pack_core.palletizing.orders.handling import Handling
from pack_core.rotations import POINTING_DOWN, Array, Pose, angle_between
from pallet_fsm.goals import Goals, Leg
from pallet_fsm.order_book import WorkItem
from pallet_fsm.palletizer_config import ThesisConfig
from pallet_fsm.printed_orientations import printed_orientation
from pallet_fsm.states import ROWS, Shape, State
from pallet_fsm.targets import Situation, ToolTarget, targets_of

FROM_ABOVE = (State.ABOVE_BOX, State.GRASP, State.RISE, State.ABOVE_TABLE, State.REGRASP)
"""States in which the tool comes down on a box, or turns to come down on it."""
STANDING_UP = (State.ROTATE, State.RELEASE_TABLE)
TO_PLACE = (
    State.LEAVE_TABLE, State.TRANSFER, State.ABOVE_PALLET, State.PRE_DEPOSIT, State.DEPOSIT,
)  # fmt: skip
"""States in which the tool has the orientation q_place (Sec. 5.3) if it holds a box."""


def wanted_orientation(state: State, item: WorkItem | None) -> Array | None:
    """Orientation q_WT, wxyz `(4,)`, that the thesis gives the tool in a state; None: it gives none.

    Over a box it is that of a tool that looks down, from which the smallest correction is taken (Sec. 7.7).
    On the way to the pallet it is that of the box's id where that works from above, else the same (Sec. 5.3).
    """
    if state in FROM_ABOVE:
        return POINTING_DOWN
    if item is None or state not in (*STANDING_UP, *TO_PLACE):
        return None
    if state in TO_PLACE and item.handling is not Handling.FLIP:
        return POINTING_DOWN
    return printed_orientation(item.box.orient_id, item.box.bundling_axis)


class ThesisMoves:
    """Every move ends in the state it begins in.

    Args:
        goals: finds tool poses over boxes and places.
        config: way-points and speeds.
    """

    def __init__(self, goals: Goals, config: ThesisConfig) -> None:
        self._goals, self._config = goals, config

    def legs(self, state: State, stop: State, item: WorkItem | None, X_WT: Pose) -> list[Leg]:
        """The ways to a state's target, best first.

        Args:
            state: the present state.
            stop: the state at whose target the arm stops next; here it is the present one.
            item: the box in work.
            X_WT: the present pose of the tool.
        """
        now = Situation(self._goals, self._config, item, X_WT)
        targets, wanted = targets_of(stop, now), wanted_orientation(stop, item)
        if wanted is not None:  # those that need equally small turns stay as they are, the quickest first
            targets = sorted(targets, key=lambda target: _turn_deg(target, wanted))
        return [self._leg(stop, target) for target in targets]

    def _leg(self, state: State, target: ToolTarget) -> Leg:
        config, row, X_WT = self._config, ROWS[state], target.X_WT
        mode = row.mode or Mode.FAST
        if row.shape is Shape.LINE and config.is_planned:
            line = Line(X_WT, config.speed, config.acceleration, label=state.name, mode=mode)
            return Leg(Path((line,)), X_WT, state, target.approach)
        move = Path((PoseMove(X_WT, label=state.name, mode=mode),))
        return Leg(move, X_WT, state, target.approach, is_checked=config.is_planned)


def _turn_deg(target: ToolTarget, q_WT: Array) -> float:
    return round(float(np.rad2deg(angle_between(target.X_WT.q, q_WT))))
