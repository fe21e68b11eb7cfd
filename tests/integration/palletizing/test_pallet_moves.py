"""The machine's moves, offered to the motion that plans them, in a cell without physics."""

import numpy as np
import pytest

from pack_core.motion.target import MotionState, MotionTarget
from pack_core.palletizing.cell import palletizing_cell
from pack_core.rotations import POINTING_DOWN, Pose, from_yaw, multiply
from pack_motion.arm.arm import load_arm
from pack_motion.controller import MotionController
from pack_motion.tracking.config import motion_set
from pack_planner.layout.layout_planner import LayoutConfig, LayoutPlanner
from pallet_fsm.blended_moves import BlendedMoves
from pallet_fsm.goals import Goals
from pallet_fsm.order_book import OrderBook
from pallet_fsm.palletizer import Palletizer
from pallet_fsm.palletizer_config import BlendedConfig, PalletizerConfig, ThesisConfig, ToolPoseConfig
from pallet_fsm.states import State
from unit.pallet_fsm.fake_cell import FakeCell
from unit.pallet_fsm.fake_motion import FakeMotion
from unit.pallet_fsm.faults import Faults
from unit.pallet_fsm.whole_orders import given_order

SHIFT_CELL = palletizing_cell("shift")


class PlannedMotion(FakeMotion):
    """Takes a move only if the real motion finds a way; the next one starts at its end."""

    def __init__(self, faults: Faults) -> None:
        super().__init__(faults)
        arm, home = load_arm("palletizing"), np.array(palletizing_cell().arm.home)
        self.start = arm.chain.forward(home)
        self._controller = MotionController(arm, motion_set("shipped"), 0.0, home)

    def take(self, target: MotionTarget, *, is_holding: bool) -> None:
        super().take(target, is_holding=is_holding)
        answer = self._controller.command(target)
        if answer.is_accepted:
            self._controller.reset(0.0, self._controller.plan.trajectory.end.q)
        else:
            self._state, self._reason = MotionState.REFUSED, answer.reason


class PlannedCell(FakeCell):
    """Its arm does only what the motion plans."""

    def __post_init__(self) -> None:
        super().__post_init__()
        self._motion = PlannedMotion(self.faults)
        self.X_WT = self._motion.start


def test_an_order_with_low_boxes_at_the_table_and_high_neighbours_on_the_pallet_is_clear() -> None:
    order = given_order(22)
    plan = LayoutPlanner(LayoutConfig()).plan(order)
    cell = PlannedCell(order)
    session = Palletizer(
        OrderBook.of_order(order, plan, palletizing_cell()), palletizing_cell(), PalletizerConfig(), 0.0
    )
    while not session.machine.is_over:
        for command in session.step(cell.observe()):
            cell.apply(command)
    assert session.report().is_complete, session.report().reason


@pytest.mark.parametrize("turns", [0, 1, 2, 3])
@pytest.mark.parametrize("place", SHIFT_CELL.pallets)
@pytest.mark.parametrize("corner", [(0.1, 0.1), (1.1, 0.1), (0.1, 0.7), (1.1, 0.7)])
def test_the_empty_tool_gets_home_from_each_corner_of_the_pallet(
    corner: tuple[float, float], place: str, turns: int
) -> None:
    cell, arm = SHIFT_CELL, load_arm("palletizing")
    p_WT = cell.deck(place).X_WD.apply([*corner, 0.5])
    X_WT = Pose(p_WT, multiply(from_yaw(0.5 * np.pi * turns), POINTING_DOWN))
    shoulder, elbow, _ = arm.inverse.branch(np.array(cell.arm.home))
    moves = BlendedMoves(Goals(cell, ToolPoseConfig()), BlendedConfig(), ThesisConfig())
    postures = arm.inverse.candidates(X_WT, shoulder, elbow)
    assert len(postures)
    for q in postures:
        motion = MotionController(arm, motion_set("shipped"), 0.0, q)
        legs = moves.legs(State.RETREAT, State.RETURN, None, X_WT)
        assert any(motion.command(MotionTarget(1, leg.move)).is_accepted for leg in legs)
