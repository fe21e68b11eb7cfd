import numpy as np
import pytest

from pack_core.palletizing.cell import palletizing_cell
from pack_core.palletizing.orders.handling import Handling
from pack_core.rotations import Pose, from_yaw, rotate, to_matrix
from pallet_fsm.palletizer_config import ToolPoseConfig
from pallet_fsm.tool_poses import CUBE, box_orientations, grasps, placements, stands
from unit.pallet_fsm.whole_orders import given_order

CELL, CONFIG = palletizing_cell(), ToolPoseConfig()
BOXES = [item for number in range(1, 26) for item in given_order(number).boxes]
TURNED = [item for item in BOXES if item.turn.handling is Handling.TABLE]
Z = np.array([0.0, 0.0, 1.0])


def in_hand(item, grasp: int) -> Pose:
    """X_TB of a box that was taken from above."""
    X_WB = Pose([-2.45, 2.52, CELL.picking_table.height + item.dims[2] / 2], from_yaw(0.1))
    return grasps(X_WB, np.array(item.dims), CONFIG)[grasp].inverse() @ X_WB


def test_a_cube_has_24_proper_rotations() -> None:
    assert len({tuple(R.ravel()) for R in CUBE}) == 24
    assert all(np.allclose(R @ R.T, np.eye(3)) for R in CUBE)


def test_a_box_with_three_different_edges_stands_on_a_given_place_in_four_ways() -> None:
    assert len(box_orientations((0.6, 0.4, 0.2), (0.4, 0.2, 0.6))) == 4


def test_a_grasp_is_over_the_middle_of_the_top_and_looks_down() -> None:
    X_WB = Pose(np.array([-2.4, 2.6, 0.8]), from_yaw(0.17))
    for X_WT in grasps(X_WB, np.array([0.6, 0.4, 0.2]), CONFIG):
        assert pytest.approx([-2.4, 2.6, 0.9 + CONFIG.pad_gap]) == X_WT.p
        assert rotate(X_WT.q, Z) == pytest.approx(-Z)
        edges = to_matrix(X_WB.q).T @ to_matrix(X_WT.q)
        assert np.abs(edges).max(axis=0) == pytest.approx([1.0, 1.0, 1.0])


@pytest.mark.parametrize("item", TURNED[::6], ids=lambda item: item.id)
@pytest.mark.parametrize("grasp", range(4))
def test_a_box_stands_at_the_tables_edge_with_its_height_and_falls_on_no_side(item, grasp: int) -> None:
    table = CELL.reorientation_table
    found = stands(item, in_hand(item, grasp), CELL, CONFIG)
    assert found
    for stand in found:
        edges = np.abs(to_matrix(stand.X_WB.q)) @ np.array(item.dims)
        assert edges[2] == pytest.approx(item.turn.extents[2])
        assert stand.X_WB.p[2] - edges[2] / 2 == pytest.approx(table.height + CONFIG.drop)
        inside = np.abs(stand.X_WB.p[:2] - table.centre) - np.array(table.size) / 2
        assert np.all(inside <= -CONFIG.overhang_margin + 1e-9)
        assert rotate(stand.X_WT.q, Z) == pytest.approx(stand.approach, abs=1e-9)


@pytest.mark.parametrize("item", TURNED[::6], ids=lambda item: item.id)
def test_the_hand_stays_in_front_of_the_table_when_a_box_is_stood_up(item) -> None:
    table = CELL.reorientation_table
    for stand in stands(item, in_hand(item, 0), CELL, CONFIG):
        axis = int(np.argmax(np.abs(stand.approach)))
        before = (table.centre[axis] - stand.X_WT.p[axis]) * stand.approach[axis]
        assert before > table.size[axis] / 2


@pytest.mark.parametrize("item", BOXES[::10], ids=lambda item: item.id)
def test_a_placement_looks_down_and_gives_the_box_its_extents_and_place(item) -> None:
    X_TB = in_hand(item, 1)
    if item.turn.handling is Handling.TABLE:
        stand = stands(item, X_TB, CELL, CONFIG)[0]
        X_TB = grasps(stand.X_WB, np.array(item.dims), CONFIG)[0].inverse() @ stand.X_WB
    found = placements(item.placed, item, X_TB, CELL.pallet.X_WP, CONFIG)
    assert len(found) >= 2
    for X_WT in found:
        X_WB = X_WT @ X_TB
        assert rotate(X_WT.q, Z) == pytest.approx(-Z, abs=1e-9)
        assert np.abs(to_matrix(X_WB.q)) @ np.array(item.dims) == pytest.approx(item.turn.extents)
        assert X_WB.p - [0, 0, CONFIG.drop] == pytest.approx(CELL.pallet.X_WP.apply(item.placed.centre))
