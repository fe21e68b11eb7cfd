"""Moves of the profile `thesis`: one to each state's target, with a stop there (section 8.4)."""

from __future__ import annotations

from pack_core.motion.moves import Line, Mode, Path, PoseMove
from pack_core.rotations import Pose
from pallet_fsm.goals import Goals, Leg
from pallet_fsm.order_book import WorkItem
from pallet_fsm.palletizer_config import ThesisConfig
from pallet_fsm.states import ROWS, Shape, State
from pallet_fsm.targets import Situation, ToolTarget, targets_of


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
            item: the box that the move is for; None: no box is left.
            X_WT: the present pose of the tool.
        """
        now = Situation(self._goals, self._config, item, X_WT)
        return [self._leg(stop, target) for target in targets_of(stop, now)]

    def _leg(self, state: State, target: ToolTarget) -> Leg:
        config, row, X_WT = self._config, ROWS[state], target.X_WT
        mode = row.mode or Mode.FAST
        if row.shape is Shape.LINE:
            line = Line(X_WT, config.speed, config.acceleration, label=state.name, mode=mode)
            return Leg(Path((line,)), X_WT, state, target.approach)
        return Leg(Path((PoseMove(X_WT, label=state.name, mode=mode),)), X_WT, state, target.approach)
