"""The placement margin algorithm of the thesis: pairwise, by layer, by shares of the free margin."""

import numpy as np
import pytest

from pack_baselines.thesis.pairwise_separator import PairwiseSeparator
from pack_core.palletizing.orders.order_file import load_order
from pack_core.palletizing.orders.placed_box import PlacedBox
from pack_core.paths import config_path
from pack_planner.layout.pallet_separator import Separation, SeparatorConfig
from unit.pack_planner.layout.blocks import PALLET

GAP = 0.010


def box(
    name: str, x: float, y: float, z: float = 0.0, size: tuple[float, float, float] = (0.3, 0.2, 0.2)
) -> PlacedBox:
    return PlacedBox(name, np.array([x, y, z]), np.array(size), 5.0)


def row(count: int) -> list[PlacedBox]:
    """Boxes that fill the pallet from edge to edge."""
    length = PALLET.length / count
    return [box(str(k), length * k, 0.0, size=(length, PALLET.width, 0.2)) for k in range(count)]


def separate(*boxes: PlacedBox, **fields: float) -> Separation:
    return PairwiseSeparator(PALLET, SeparatorConfig(**fields)).separate(boxes, GAP)


def test_a_pair_is_parted_along_the_axis_that_needs_less_by_shares_of_the_free_margin() -> None:
    """Along x 2 mm are missing, along y 10 mm; 0.3 m are free to the left, 0.292 m to the right."""
    found = separate(box("left", 0.3, 0.3), box("right", 0.608, 0.3))
    assert found.displacements[:, 1] == pytest.approx([0.0, 0.0])
    left, right = found.displacements[:, 0]
    assert right - left == pytest.approx(0.002)
    assert -left / right == pytest.approx(0.3 / 0.292)
    assert found.gap == pytest.approx(GAP)


def test_boxes_with_enough_clearance_along_one_axis_stay() -> None:
    found = separate(box("left", 0.0, 0.0), box("right", 0.31, 0.1))
    assert found.displacements == pytest.approx(np.zeros((2, 2)))


def test_a_box_without_room_along_the_nearer_axis_goes_along_the_other() -> None:
    whole = (PALLET.length - 0.305, 0.2, 0.2)
    found = separate(box("short", 0.0, 0.0), box("long", 0.305, 0.001, size=whole))
    assert found.is_feasible
    assert found.virtual_margin == 0.0
    assert found.displacements[1, 1] - found.displacements[0, 1] == pytest.approx(0.209)


def test_an_upper_box_moves_with_what_carries_it() -> None:
    found = separate(box("left", 0.3, 0.3), box("right", 0.6, 0.3), box("top", 0.6, 0.3, 0.2))
    assert found.displacements[2] == pytest.approx(found.displacements[1])


def test_a_full_pallet_is_enlarged_by_a_virtual_margin() -> None:
    found = separate(*row(2))
    assert found.is_feasible
    assert found.virtual_margin == pytest.approx(0.005)  # half of the gap at both borders


def test_what_no_margin_can_part_is_infeasible_and_stays() -> None:
    found = separate(*row(2), max_margin=0.004)
    assert not found.is_feasible
    assert found.displacements == pytest.approx(np.zeros((2, 2)))


def test_a_row_of_which_each_correction_closes_the_next_gap_does_not_settle() -> None:
    """Three gaps need 15 mm at both borders; 20 mm are allowed."""
    assert not separate(*row(4)).is_feasible


def test_boxes_of_different_layers_are_not_parted_though_they_overlap_in_height() -> None:
    low, high = box("low", 0.3, 0.3, size=(0.3, 0.2, 0.3)), box("high", 0.6, 0.3, 0.1)
    assert separate(low, high).displacements == pytest.approx(np.zeros((2, 2)))


@pytest.mark.parametrize("number", [3, 9, 20])
def test_an_orders_layers_have_the_gap(number: int) -> None:
    order = load_order(config_path("orders", f"order_{number:02}.json"))
    found = PairwiseSeparator(order.pallet, SeparatorConfig()).separate(order.placed, GAP)
    assert found.is_feasible
    assert found.gap >= GAP - 1e-4
