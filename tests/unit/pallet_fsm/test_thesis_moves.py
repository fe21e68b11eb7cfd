"""The way-points and orientations of the profile `thesis`: section 8.4 and chapter 5."""

import numpy as np
import pytest

from pack_core.motion.moves import UP, Line, PoseMove
from pack_core.palletizing.cell import palletizing_cell
from pack_core.palletizing.orders.handling import ARRIVAL, PERMUTATIONS, Handling
from pack_core.rotations import POINTING_DOWN, Pose, angle_between, rotate
from pallet_fsm.goals import Goals
from pallet_fsm.order_book import OrderBook, WorkItem
from pallet_fsm.palletizer_config import ThesisConfig, ToolPoseConfig
from pallet_fsm.printed_orientations import EULER, printed_extents, printed_orientation
from pallet_fsm.report import BoxOutcome
from pallet_fsm.states import State
from pallet_fsm.thesis_moves import ThesisMoves, wanted_orientation
from unit.pallet_fsm.whole_orders import given_order, plan_as_given

CELL, CONFIG = palletizing_cell(), ThesisConfig()
MOVES = ThesisMoves(Goals(CELL, ToolPoseConfig()), CONFIG)
AHEAD = Pose(np.array([-0.5, 2.2, 1.2]), POINTING_DOWN)


def item_with(handling: Handling, number: int = 9) -> WorkItem:
    """The first box of an order that is handled so, held by the middle of its top."""
    order = given_order(number)
    items = OrderBook.of_order(order, plan_as_given(order), CELL).items
    item = next(item for item in items if item.handling is handling)
    item.X_TB = Pose(np.array([0.0, 0.0, 0.5 * item.dims[2]]), POINTING_DOWN)
    return item


def first(state: State, item: WorkItem | None, X_WT: Pose = AHEAD) -> Pose:
    return MOVES.legs(state, state, item, X_WT)[0].X_WT


def test_the_printed_angles_make_the_orders_extents_for_ids_0_2_4_and_5_of_axis_z() -> None:
    assert {key for key in EULER if printed_extents(key) == PERMUTATIONS[key]} == {0, 2, 4, 5}
    assert printed_extents(1) == printed_extents(5)
    assert printed_extents(2) == printed_extents(3)
    assert {printed_extents(key) for key in EULER} < set(PERMUTATIONS.values())


def test_the_printed_angles_are_not_those_of_axis_y_whose_bypass_rules_are_others() -> None:
    upright = next(key for key in EULER if tuple(ARRIVAL["y"][n] for n in PERMUTATIONS[key]) == (0, 1, 2))
    assert upright == 5  # bypassed in state 5 with axis y
    assert printed_extents(upright) != (0, 1, 2)
    assert printed_orientation(upright, "y") is None


def test_id_0_looks_down_id_4_is_a_quarter_turn_and_2_and_5_come_in_horizontally() -> None:
    found = {key: printed_orientation(key, "z") for key in (0, 2, 4, 5)}
    ways = {key: rotate(q, np.array([0.0, 0.0, 1.0])) for key, q in found.items() if q is not None}
    assert ways[0] == pytest.approx(-UP)
    assert ways[4] == pytest.approx(-UP)
    assert ways[2] == pytest.approx([1.0, 0.0, 0.0])
    assert ways[5] == pytest.approx([0.0, 1.0, 0.0])
    assert np.rad2deg(angle_between(found[0], found[4])) == pytest.approx(90.0)


def test_the_pre_deposit_is_10_mm_over_the_place_and_16_is_over_the_start_of_the_corridor() -> None:
    item = item_with(Handling.FLIP)
    place, close, over = (first(s, item) for s in (State.DEPOSIT, State.PRE_DEPOSIT, State.ABOVE_PALLET))
    assert close.p - place.p == pytest.approx(0.01 * UP)
    insertion = item.plan.insertion
    assert over.p - place.p == pytest.approx(insertion.corridor * insertion.outward + CONFIG.above * UP)


def test_the_tool_goes_back_from_a_placed_box_to_where_it_came_from() -> None:
    item = item_with(Handling.FLIP)
    place, over = first(State.DEPOSIT, item), first(State.ABOVE_PALLET, item)
    item.finish(BoxOutcome.PLACED)
    assert first(State.RETREAT, item, place).p == pytest.approx(over.p)


def test_the_tool_rises_straight_from_a_box_that_was_skipped() -> None:
    item = item_with(Handling.FLIP)
    item.finish(BoxOutcome.SKIPPED)
    assert first(State.RETREAT, item).p - AHEAD.p == pytest.approx(CONFIG.above * UP)


def test_the_tool_turns_to_look_down_while_it_rises_from_table_b() -> None:
    item = item_with(Handling.TABLE)
    stand = MOVES.legs(State.RELEASE_TABLE, State.RELEASE_TABLE, item, AHEAD)[0]
    item.let_go(stand.X_WT, 0.0)
    item.approach = stand.approach
    risen = first(State.RISE, item, stand.X_WT)
    assert risen.p - stand.X_WT.p == pytest.approx(CONFIG.above * UP)
    assert rotate(risen.q, np.array([0.0, 0.0, 1.0])) == pytest.approx(-UP)


def test_a_flipped_box_is_placed_with_the_orientation_of_its_id_and_others_with_the_default() -> None:
    flipped, upright = item_with(Handling.FLIP), item_with(Handling.NONE, 3)
    assert flipped.box.bundling_axis == "z"
    assert wanted_orientation(State.TRANSFER, flipped) == pytest.approx(printed_orientation(4, "z"))
    assert wanted_orientation(State.TRANSFER, upright) == pytest.approx(POINTING_DOWN)
    assert wanted_orientation(State.RETREAT, upright) is None


def test_unplanned_moves_are_the_goal_alone_and_go_unchecked() -> None:
    sent = ThesisMoves(Goals(CELL, ToolPoseConfig()), ThesisConfig(is_planned=False))
    for moves, kind in ((MOVES, Line), (sent, PoseMove)):
        leg = moves.legs(State.DEPOSIT, State.DEPOSIT, item_with(Handling.FLIP), AHEAD)[0]
        assert isinstance(leg.move.segments[0], kind)
        assert leg.is_checked is (kind is Line)
