"""Boxes come down along the vertical of the pallet: what stands on it is passed at one distance."""

import numpy as np
import pytest

from pack_core.motion.moves import UP, Transfer
from pack_core.palletizing.cell import PalletizingCell, palletizing_cell
from pack_core.palletizing.imperfections import Displacement
from pack_core.palletizing.orders.layout_plan import Insertion, PlannedBox
from pack_core.palletizing.orders.placed_box import PlacedBox
from pack_core.rotations import POINTING_DOWN, Pose, from_yaw
from pallet_fsm.blended_moves import BlendedMoves
from pallet_fsm.goals import Goals
from pallet_fsm.order_book import WorkItem
from pallet_fsm.palletizer_config import BlendedConfig, ThesisConfig, ToolPoseConfig
from pallet_fsm.states import State
from pallet_fsm.targets import Situation, targets_of
from pallet_fsm.tool_poses import grasps
from unit.pallet_fsm.whole_orders import given_order

ASKEW = Displacement(shift=(0.002, -0.003, 0.004), turn=(-0.0016, -0.0026, -0.0039))
BOX = given_order(17).boxes[0]


def cell_with(displacement: Displacement) -> PalletizingCell:
    cell = palletizing_cell()
    pallet = cell.pallet.model_copy(update={"displacement": displacement})
    return cell.model_copy(update={"pallet": pallet})


def held_item() -> WorkItem:
    """A box in the gripper, with a place on the pallet to which it comes along its x axis."""
    placed = PlacedBox(BOX.id, np.array([0.3, 0.2, 0.4]), np.array(BOX.dims), BOX.weight)
    along_x = Insertion("East", np.array([1.0, 0.0, 0.0]), 0.2)
    X_WB = Pose(np.array([-2.4, 2.6, 0.8]))
    X_TB = grasps(X_WB, np.array(BOX.dims), ToolPoseConfig())[0].inverse() @ X_WB
    return WorkItem(BOX, PlannedBox(placed, along_x), X_TB=X_TB)


def on_pallet(cell: PalletizingCell, v_W: np.ndarray) -> np.ndarray:
    """A vector in the world, along the pallet's axes."""
    return (cell.pallet.X_WP.inverse() @ Pose(cell.pallet.X_WP.p + v_W)).p


@pytest.mark.parametrize("displacement", [Displacement(), ASKEW], ids=["level", "askew"])
def test_blended_moves_come_down_along_the_pallets_vertical(displacement: Displacement) -> None:
    cell, config = cell_with(displacement), BlendedConfig()
    moves = BlendedMoves(Goals(cell, ToolPoseConfig()), config, ThesisConfig())
    legs = moves.legs(State.LIFT, State.DEPOSIT, held_item(), Pose(np.zeros(3), from_yaw(0.0)))
    outs = {tuple(on_pallet(cell, leg.move.lines[0].X_WT.p - leg.X_WT.p).round(9)) for leg in legs}
    assert outs == {(config.standoff, 0.0, config.final_height), (0.0, 0.0, config.final_height)}
    for leg in legs:
        assert isinstance(leg.move, Transfer)
        assert on_pallet(cell, leg.move.hover.direction) == pytest.approx(UP)


def test_way_points_over_the_pallet_are_along_its_axes() -> None:
    cell, config, item = cell_with(ASKEW), ThesisConfig(), held_item()
    now = Situation(Goals(cell, ToolPoseConfig()), config, item, Pose(np.zeros(3), from_yaw(0.0)))
    over, close = targets_of(State.ABOVE_PALLET, now), targets_of(State.PRE_DEPOSIT, now)
    for above, before in zip(over, close, strict=True):
        rise = on_pallet(cell, above.X_WT.p - before.X_WT.p)
        start = item.plan.insertion.corridor * item.plan.insertion.outward
        assert rise == pytest.approx(start + (config.above - config.final_height) * UP)


def test_the_empty_tool_rises_along_the_pallets_vertical_in_both_profiles() -> None:
    cell, X_WT = cell_with(ASKEW), Pose(np.array([0.0, 0.5, 0.6]), POINTING_DOWN)
    goals = Goals(cell, ToolPoseConfig())
    home, searched = BlendedMoves(goals, BlendedConfig(), ThesisConfig()).legs(
        State.RETREAT, State.RETURN, None, X_WT
    )
    assert on_pallet(cell, searched.move.depart.direction) == pytest.approx(UP)
    now = Situation(goals, ThesisConfig(), None, X_WT)
    ends = [line.X_WT.p for line in home.move.segments[:2]]
    ends += [target.X_WT.p for target in targets_of(State.RETREAT, now)]
    assert len(ends) == 3
    for end in ends:
        rise = on_pallet(cell, end - X_WT.p)
        assert rise / np.linalg.norm(rise) == pytest.approx(UP)
    assert ends[1][2] == pytest.approx(BlendedConfig().safe[2])
