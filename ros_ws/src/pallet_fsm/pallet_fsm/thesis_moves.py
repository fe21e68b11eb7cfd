"""Moves of the thesis's profile: one to each state's fixed way-point (section 8.4)."""

from __future__ import annotations

import numpy as np
from pydantic import Field, PositiveFloat

from pack_core.config import Config
from pack_core.motion.moves import UP, Line, Mode, Path, PoseMove
from pack_core.palletizing.cell import PalletizingCell
from pack_core.rotations import Array, Pose
from pallet_fsm.goals import Goals, Leg, raised
from pallet_fsm.states import ROWS, State
from pallet_fsm.tool_poses import PoseConfig
from pallet_fsm.work_item import WorkItem

Point = tuple[float, float, float]


class ThesisConfig(Config):
    """Way-points and speeds."""

    safe_pick: Point = Field(default=(-2.5, 2.5, 2.0), description="over table A [m]")
    safe_table: Point = Field(default=(-0.5, 2.5, 2.0), description="over table B [m]")
    safe_pallet: Point = Field(default=(0.0, 0.5, 2.0), description="over the pallet [m]")
    above: PositiveFloat = Field(default=0.30, description="way-points over a goal [m]")
    step_back: PositiveFloat = Field(default=0.20, description="from a box on table B [m]")
    before_table: PositiveFloat = Field(default=0.10, description="over the place on table B [m]")
    final_height: PositiveFloat = Field(default=0.01, description="of the pre-deposit over the place [m]")
    standoff: PositiveFloat = Field(default=0.04, description="beside the place, where an insertion begins")
    speed: PositiveFloat = Field(default=0.25, description="of lines [m/s]")
    acceleration: PositiveFloat = Field(default=2.5, description="of lines [m/s^2]")


SAFE = {
    State.SAFE_PICK: "safe_pick", State.SAFE_TABLE: "safe_table", State.LEAVE_TABLE: "safe_table",
    State.TRANSFER: "safe_pallet",
}  # fmt: skip
"""Which of the safe positions a state goes to."""
LINES = (
    State.GRASP, State.LIFT, State.RELEASE_TABLE, State.STEP_BACK, State.RISE, State.REGRASP,
    State.LIFT_TABLE, State.PRE_DEPOSIT, State.DEPOSIT, State.RETREAT,
)  # fmt: skip
"""States whose way-point is reached along a straight line."""


class ThesisMoves:
    """Every move ends in the state it begins in.

    Args:
        cell: the cell's physical facts.
        poses: distances between tool, boxes and tables.
        config: way-points and speeds.
    """

    def __init__(self, cell: PalletizingCell, poses: PoseConfig, config: ThesisConfig) -> None:
        self._goals, self._config = Goals(cell, poses), config

    def legs(self, state: State, item: WorkItem | None, X_WT: Pose) -> list[Leg]:
        """The way to a state's way-point; `item` is the box in work, X_WT the tool now."""
        config, up = self._config, self._config.above * UP
        if state is State.RETREAT:
            return [self._leg(state, raised(X_WT, up))]
        if state is State.RETURN:
            return [self._leg(state, Pose(np.array(config.safe_pallet), X_WT.q))]
        assert item is not None
        if state in (State.ROTATE, State.RELEASE_TABLE):
            height = config.before_table if state is State.ROTATE else 0.0
            found = self._goals.stands(item, X_WT)
            return [self._leg(state, raised(stand.X_WT, height * UP), stand.approach) for stand in found]
        if state in (State.LIFT, State.RISE, State.LIFT_TABLE):
            return [self._leg(state, raised(X_WT, up))]
        if state is State.STEP_BACK:
            assert item.approach is not None
            return [self._leg(state, raised(X_WT, -config.step_back * item.approach))]
        return [self._leg(state, goal) for goal in self._way_points(state, item, X_WT)]

    def _way_points(self, state: State, item: WorkItem, X_WT: Pose) -> list[Pose]:
        """Of the states that go over or to a box, a place or a safe position."""
        config, up = self._config, self._config.above * UP
        if state in SAFE:
            point = np.array(getattr(config, SAFE[state]))
            return [Pose(point, goal.q) for goal in self._oriented(state, item, X_WT)]
        if state in (State.ABOVE_BOX, State.ABOVE_TABLE, State.GRASP, State.REGRASP):
            offset = up if state in (State.ABOVE_BOX, State.ABOVE_TABLE) else 0.0 * UP
            return [raised(goal, offset) for goal in self._goals.grasps(item, X_WT)]
        before = item.plan.insertion.offset(config.standoff, config.final_height)
        offset = {State.ABOVE_PALLET: before + up, State.PRE_DEPOSIT: before}.get(state, 0.0 * UP)
        return [raised(goal, offset) for goal in self._goals.placements(item, X_WT)]

    def _oriented(self, state: State, item: WorkItem, X_WT: Pose) -> list[Pose]:
        """Poses with the orientation that the tool has in a safe position."""
        turns = state in (State.LEAVE_TABLE, State.TRANSFER) and item.X_TB is not None
        return self._goals.placements(item, X_WT) if turns else [X_WT]

    def _leg(self, state: State, X_WT: Pose, approach: Array | None = None) -> Leg:
        config, mode = self._config, ROWS[state].mode or Mode.FAST
        if state in LINES:
            line = Line(X_WT, config.speed, config.acceleration, label=state.name, mode=mode)
            return Leg(Path((line,)), X_WT, state, approach)
        return Leg(Path((PoseMove(X_WT, label=state.name, mode=mode),)), X_WT, state, approach)
