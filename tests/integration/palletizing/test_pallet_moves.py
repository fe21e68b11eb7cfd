"""The machine's moves, offered to the motion that plans them, in a cell without physics."""

import numpy as np

from pack_core.motion.target import MotionState, MotionTarget
from pack_core.palletizing.cell import palletizing_cell
from pack_motion.arm.arms import load_arm
from pack_motion.controller import MotionController
from pack_motion.tracking.config import motion_set
from pack_planner.layout.layout_planner import LayoutConfig, LayoutPlanner
from pallet_fsm.palletizer import Palletizer
from pallet_fsm.palletizer_config import PalletizerConfig
from unit.pallet_fsm.fake_cell import FakeCell
from unit.pallet_fsm.whole_orders import given_order


class PlannedCell(FakeCell):
    """Takes a move only if the motion does; the arm is then at its end."""

    def __post_init__(self) -> None:
        super().__post_init__()
        arm, home = load_arm("palletizing"), np.array(palletizing_cell().arm.home)
        self.X_WT = arm.chain.forward(home)
        self._motion = MotionController(arm, motion_set("shipped"), 0.0, home)

    def _take(self, target: MotionTarget) -> None:
        super()._take(target)
        answer = self._motion.command(target)
        if not answer.is_accepted:
            self._state, self._reason = MotionState.REFUSED, answer.reason
        else:
            self._motion.reset(self.time, self._motion.plan.trajectory.end.q)


def test_an_order_with_low_boxes_at_the_table_and_high_neighbours_on_the_pallet_is_clear() -> None:
    order = given_order(22)
    plan = LayoutPlanner(LayoutConfig()).plan(order)
    cell = PlannedCell(order)
    session = Palletizer(order, plan, palletizing_cell(), PalletizerConfig(), 0.0)
    while not session.machine.is_over:
        for command in session.step(cell.observe()):
            cell.apply(command)
    assert session.report().is_complete, session.report().reason
